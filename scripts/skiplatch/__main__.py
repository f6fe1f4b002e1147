"""``python -m skiplatch``."""

from skiplatch.cli import main

main()
