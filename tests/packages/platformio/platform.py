"""The platform of `platform.json`: it has no packages of its own."""

from platformio.public import PlatformBase


class AtmelavrPlatform(PlatformBase):
    """What PlatformIO looks for by that name."""
