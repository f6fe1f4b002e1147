"""Packed logs: read like any other, and refused where they unpack to more than can be meant."""

import gzip
import zipfile
from pathlib import Path

import pytest

from skiplatch.errors import InputError
from skiplatch.importing import can_frames, captures
from skiplatch.importing.can_frames import read_can
from skiplatch.importing.captures import read_capture
from test_import_can import bus_log

EDGES_NS = [5_000_000_000, 5_500_000_000]
LATCHES_NS = [5_000_040_000, 5_500_040_700]


def session(path: Path, metadata: str) -> Path:
    """Write a session of sigrok without samples."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("metadata", metadata)
    return path


def test_a_packed_log_is_read_as_what_is_in_it(tmp_path: Path) -> None:
    plain = Path(bus_log(tmp_path, EDGES_NS, LATCHES_NS))
    packed = tmp_path / "bus.log.gz"
    packed.write_bytes(gzip.compress(plain.read_bytes()))

    assert repr(read_can(packed).columns) == repr(read_can(plain).columns)


def test_a_log_that_unpacks_to_more_than_can_be_meant_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(can_frames, "MOST_BYTES", 4 << 20)
    packed = tmp_path / "bus.log.gz"
    packed.write_bytes(gzip.compress(bytes(5 << 20)))

    with pytest.raises(InputError, match=r"bus\.log in it is larger than 4194304 bytes"):
        read_can(packed)


def test_a_session_whose_metadata_are_no_such_thing_is_refused(tmp_path: Path) -> None:
    metadata = "[device 1]\ncapturefile=logic-1\n" + "#" * captures.MOST_METADATA

    with pytest.raises(InputError, match="metadata in it is larger than"):
        read_capture(session(tmp_path / "s.sr", metadata))


def test_a_session_without_metadata_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "s.sr", "w") as archive:
        archive.writestr("other", "")

    with pytest.raises(InputError, match="no session of sigrok"):
        read_capture(tmp_path / "s.sr")
