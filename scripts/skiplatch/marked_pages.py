"""Pages of the documentation with a part that a program writes, between two lines that mark it."""


def with_part(page: str, part: str, begin: str, end: str) -> str:
    """Give the page with another part between its marks.

    Args:
        page: All of it.
        part: What shall stand there; ends with a line end, as the marks do.
        begin: The line above.
        end: The line below.

    Raises:
        ValueError: The page has no such marks.
    """
    before, begun, rest = page.partition(begin)
    _, ended, after = rest.partition(end)
    if not begun or not ended:
        raise ValueError(f"expected the lines {begin.strip()} and {end.strip()}")
    return f"{before}{begin}\n{part}\n{end}{after}"
