"""Pages are in short sentences: at most 16 words in the mean of a page, never more than 40.

Code, pictures and headings are no prose. A piece of code within a line counts as one word, a link
by its text. An item of a list ends a sentence. Cells of tables are held to 40 words, and are left
out of the mean: they are mostly no sentences.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]
MEAN_WORDS, MOST_WORDS = 16.0, 40

CODE_BLOCK = re.compile(r"^( *)```.*?^\1```$", re.DOTALL | re.MULTILINE)
NOT_PROSE = re.compile(r"^\s*(#|!\[|<|\|?[-:| ]+\|$)")
NEW_PARAGRAPH = re.compile(r"^\s*([-*+]|\d+\.)\s+|^\s*>\s*")
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
SENTENCE_END = re.compile(r"(?<!\be\.g)(?<!\bi\.e)(?<!\bvs)[.!?][)*_\"”]*\s+(?=\W*[A-Z0-9Α-ωÄÖÜ`])")


def paragraphs(page: str) -> Iterator[str]:
    """Give each paragraph, item of a list and cell of a table; cells begin with a bar."""
    gathered: list[str] = []
    for line in [*CODE_BLOCK.sub("\n", page).splitlines(), ""]:
        is_row = line.startswith("|")
        if not line.strip() or is_row or NOT_PROSE.match(line) or NEW_PARAGRAPH.match(line):
            yield " ".join(gathered)
            gathered = []
        if NOT_PROSE.match(line):
            continue
        if is_row:
            yield from (f"|{cell}" for cell in re.split(r"(?<!\\)\||<br>", line))
        else:
            gathered.append(NEW_PARAGRAPH.sub("", line))


def sentences(text: str) -> list[list[str]]:
    """Give the words of each sentence of a paragraph."""
    plain = LINK.sub(r"\1", re.sub(r"`[^`]*`", "Code", text))
    words = (sentence.split() for sentence in SENTENCE_END.split(plain))
    found = [[word for word in each if re.search(r"\w", word)] for each in words]
    return [each for each in found if each]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_sentences_are_short(page: Path) -> None:
    texts = list(paragraphs(page.read_text(encoding="utf-8")))

    every = [sentence for text in texts for sentence in sentences(text)]
    prose = [sentence for text in texts if text[:1] != "|" for sentence in sentences(text)]

    assert [" ".join(each) for each in every if len(each) > MOST_WORDS] == []
    assert sum(map(len, prose)) <= MEAN_WORDS * len(prose)


def test_sentences_are_told_apart() -> None:
    page = """# A heading is none

Two lines are
one [sentence](of/four.md) here. The `second: one.` ends 1.5 mm on, e.g. here.

- an item
- another. With two.

```sh
no prose. At all.
```

| cell one | a. B c |
|---|---|
"""

    counted = [[len(each) for each in sentences(text)] for text in paragraphs(page)]

    assert [each for each in counted if each] == [[6, 8], [2], [1, 2], [2], [1, 2]]


def test_a_long_sentence_is_seen() -> None:
    (words,) = sentences("word " * 41 + "end.")

    assert len(words) == 42
