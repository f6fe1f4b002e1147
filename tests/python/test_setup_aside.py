"""Packages from another release of Debian are those of aside.lock, or it is told."""

import hashlib
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = "minisat_1%3a2.2.1-8_amd64.deb"


def checked(folder: Path, lock: str) -> subprocess.CompletedProcess[str]:
    """Hold one package that was downloaded to a lock."""
    (folder / "setup").mkdir()
    (folder / "setup" / "aside.lock").write_text(lock)
    (folder / "deb").mkdir()
    (folder / "deb" / PACKAGE).write_bytes(b"contents")
    script = f'scripts="{folder}"; aside="{folder}"; . scripts/setup/apt_aside.sh; check_aside'
    return subprocess.run(
        ["/bin/sh", "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )


def test_a_package_of_the_lock_is_taken_without_a_word(tmp_path: Path) -> None:
    done = checked(tmp_path, f"{hashlib.sha256(b'contents').hexdigest()}  {PACKAGE}\n")

    assert (done.returncode, done.stderr) == (0, "")


def test_a_package_with_other_contents_is_refused(tmp_path: Path) -> None:
    done = checked(tmp_path, f"{hashlib.sha256(b'others').hexdigest()}  {PACKAGE}\n")

    assert (done.returncode, done.stderr) == (1, f"{PACKAGE} is not the one of aside.lock\n")


@pytest.mark.parametrize("lock", ["", f"{'0' * 64}  minisat_1%3a2.2.1-7_amd64.deb\n"])
def test_a_package_that_has_moved_on_is_told(tmp_path: Path, lock: str) -> None:
    done = checked(tmp_path, lock)

    assert done.returncode == 0
    assert done.stderr.startswith(f"{PACKAGE} is not in aside.lock")
