"""Diagnose campaigns one after the other in one process: what spread ones are held beside."""

import sys
from collections.abc import Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from skiplatch.commands.diagnose_many import tell
from skiplatch.commands.examining import Asked
from skiplatch.commands.options import write_json
from skiplatch.played_files import read_playable


def main(arguments: Sequence[str]) -> None:
    """Write the diagnoses of folders to the first argument, as `skiplatch diagnose` does."""
    out, *folders = map(Path, arguments)
    with threadpool_limits(1):
        told = [tell(read_playable(folder), Asked(seed=1)) for folder in folders]
    write_json(out, [one.document for one in told])


if __name__ == "__main__":
    main(sys.argv[1:])
