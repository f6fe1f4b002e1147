"""Fuzz one reader with Atheris, which keeps the inputs that reach new code.

    python tests/fuzz/guided.py READER -max_total_time=SECONDS FOLDER…

READER is one of `readers.READERS`; the rest is libFuzzer's. `fuzz_readers.py` calls it.
"""

import sys

import atheris

with atheris.instrument_imports(include=["skiplatch", "tomllib"]):
    from readers import check


def main() -> None:
    """Run until the time is over, or something is found; libFuzzer ends the process."""
    name, *options = sys.argv[1:]

    def one_input(data: bytes) -> None:
        check(name, data)

    atheris.Setup([sys.argv[0], *options], one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
