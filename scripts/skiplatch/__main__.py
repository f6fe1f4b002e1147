"""``skiplatch`` and ``python -m skiplatch``: begins before what the commands need is loaded."""

import signal


def main() -> None:
    """Run the command line; whoever interrupts it while it loads ends it without a word."""
    is_ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if is_ours:  # else the caller has it ignored
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from skiplatch import cli  # noqa: PLC0415

    if is_ours:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    cli.main()


if __name__ == "__main__":
    main()
