"""What the nominal chain says of an input path: how late it may latch."""

from dataclasses import dataclass

from skiplatch.campaign import InputPath, Nominal


@dataclass(frozen=True, slots=True)
class Reaction:
    """The time from the edge to the latch: uniform from `earliest_us` to `latest_us`."""

    earliest_us: float
    width_us: float

    @property
    def latest_us(self) -> float:
        """The greatest."""
        return self.earliest_us + self.width_us

    @property
    def mean_us(self) -> float:
        """The mean, which calibrates out at one feed."""
        return self.earliest_us + self.width_us / 2.0


def reaction_of(nominal: Nominal, path: InputPath) -> Reaction:
    """Give the reaction of a path: jitter of the skip input, or scan period of the PLC task."""
    if path == InputPath.PLC:
        return Reaction(nominal.input.filter_us, nominal.plc.scan_us)
    return Reaction(nominal.input.filter_us + nominal.skip.latency_us, nominal.skip.jitter_us)
