"""Pictures: sound SVG, readable in both schemes, with nothing written over anything else."""

import re
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from skiplatch.campaign import InputPath
from skiplatch.errors import InputError
from skiplatch.figures import colours, theme
from skiplatch.figures.cycle_times import draw_cycle_times
from skiplatch.figures.feeds import draw_feeds
from skiplatch.figures.latch_errors import draw_latch_errors
from skiplatch.figures.one_point import draw_one_point
from skiplatch.figures.scan_position import draw_scan_position
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import latch_errors
from skiplatch.latch.probing import DEFAULT_RIG, one_touch

SVG = "{http://www.w3.org/2000/svg}"
EFFORT = Effort(2000, seed=1, jobs=2)
FEED = 3000.0
READABLE = 4.5  # contrast of letters, WCAG 2 level AA
VISIBLE = 1.15  # of what only helps the eye along


def draw_errors(path: Path, *paths: InputPath) -> None:
    errors = {
        input_path: latch_errors(one_touch(DEFAULT_RIG, input_path, FEED), EFFORT)
        for input_path in paths
    }
    draw_latch_errors(path, errors, FEED)


DRAWERS: dict[str, Callable[[Path], None]] = {
    "scan_position": lambda path: draw_scan_position(path, seed=1),
    "feeds": lambda path: draw_feeds(path, EFFORT),
    "one_point": draw_one_point,
    "cycle_times": lambda path: draw_cycle_times(path, EFFORT),
    "latch_errors": lambda path: draw_errors(path, InputPath.SKIP, InputPath.PLC),
    "latch_errors_plc": lambda path: draw_errors(path, InputPath.PLC),
}


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, Figure]]:
    """Every picture as text and as what it was drawn from."""
    figures: list[Figure] = []
    draw_svg = theme.svg_of

    def note_and_draw(figure: Figure) -> str:
        figures.append(figure)
        return draw_svg(figure)

    folder = tmp_path_factory.mktemp("pictures")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(theme, "svg_of", note_and_draw)
        for name, draw in DRAWERS.items():
            draw(folder / f"{name}.svg")
    texts = {name: (folder / f"{name}.svg").read_text() for name in DRAWERS}
    return {name: (texts[name], figure) for name, figure in zip(DRAWERS, figures, strict=True)}


@pytest.fixture(params=list(DRAWERS))
def picture(
    request: pytest.FixtureRequest, drawn: dict[str, tuple[str, Figure]]
) -> tuple[str, Figure]:
    return drawn[request.param]


def test_picture_is_svg_with_a_title_and_a_description(picture: tuple[str, Figure]) -> None:
    root = ET.fromstring(picture[0])  # noqa: S314

    assert root.tag == f"{SVG}svg"
    assert root.get("role") == "img"
    assert root.get("aria-labelledby") == "title description"
    title, description = root.find(f"{SVG}title"), root.find(f"{SVG}desc")
    assert title is not None
    assert description is not None
    assert title.get("id") == "title"
    assert description.get("id") == "description"
    assert title.text
    assert len(description.text or "") > 60


def test_picture_needs_nothing_from_elsewhere(picture: tuple[str, Figure]) -> None:
    references = re.findall(r'(?:href|src)="([^"]*)"|url\(([^)]*)\)', picture[0])

    assert all((href or url).startswith("#") for href, url in references)
    assert "<text" not in picture[0]  # letters are outlines
    assert "<script" not in picture[0]


def test_every_colour_has_a_dark_counterpart(picture: tuple[str, Figure]) -> None:
    style = picture[0].split("</style>")[0]
    drawing = picture[0].removeprefix(style)
    drawn = set(re.findall(r"#[0-9a-f]{6}\b", drawing))

    assert drawn <= set(colours.DARK)
    assert colours.PAPER in drawn
    for light in drawn:
        for part in ("fill", "stroke"):
            rule = f'[style*="{part}: {light}"] {{ {part}: {colours.DARK[light]} !important }}'
            assert rule in style


def test_nothing_is_black_by_leaving_its_colour_out(picture: tuple[str, Figure]) -> None:
    """Matplotlib does not write black, so a dark scheme could not replace it."""
    root = ET.fromstring(picture[0])  # noqa: S314

    for path in root.iter(f"{SVG}path"):
        in_definitions = path.get("style") is None
        assert in_definitions or re.search(r"(fill|stroke): (#|none)", path.get("style", ""))


def extents(figure: Figure) -> dict[str, Bbox]:
    """Give the place of every text that is drawn, in pixels."""
    found: dict[str, Bbox] = {}
    draw = Text.draw

    def note_and_draw(text: Text, renderer: RendererBase) -> None:
        draw(text, renderer)
        if text.get_visible() and text.get_text().strip():
            found[f"{text.get_text()} {id(text)}"] = Text.get_window_extent(text, renderer)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Text, "draw", note_and_draw)
        FigureCanvasAgg(figure).draw()  # type: ignore[no-untyped-call]
    return found


def test_no_text_lies_over_another_or_leaves_the_picture(picture: tuple[str, Figure]) -> None:
    figure = picture[1]
    boxes = extents(figure)

    assert len(boxes) > 5
    for text, box in boxes.items():
        inside = figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
        assert inside, text
        assert figure.bbox.y0 <= box.y0, text
        assert box.y1 <= figure.bbox.y1, text
    for (one, its_box), (other, other_box) in combinations(boxes.items(), 2):
        assert not its_box.overlaps(other_box), (one, other)


def test_axes_name_their_units(picture: tuple[str, Figure]) -> None:
    for axes in picture[1].axes:
        assert re.search(r", (µm|s|mm/min|% per µs)$", axes.get_ylabel())
    assert re.search(r", ?(µm|s|ms|mm/min|µs)$|, µs$", picture[1].axes[-1].get_xlabel())


def test_same_picture_is_the_same_file(tmp_path: Path) -> None:
    for name in ("one", "other"):
        draw_scan_position(tmp_path / f"{name}.svg", seed=1)

    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "other.svg").read_bytes()


def luminance(colour: str) -> float:
    """Relative luminance after WCAG 2."""
    parts = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_letters_and_lines_stand_out_from_the_ground(scheme: str) -> None:
    tones = {tone: tone if scheme == "light" else dark for tone, dark in colours.DARK.items()}
    paper = tones.pop(colours.PAPER)
    areas = (colours.GRID, colours.SKIP_LIGHT, colours.PLC_LIGHT)

    for tone, colour in tones.items():
        assert contrast(colour, paper) >= (VISIBLE if tone in areas else READABLE), tone


def test_colours_can_be_told_apart_in_the_file() -> None:
    assert len(set(colours.DARK.values())) == len(colours.DARK)


def test_words_are_escaped(tmp_path: Path) -> None:
    words = theme.Words(title="a < b & c", description="\\1 <x>")
    with theme.picture(tmp_path / "a.svg", words):
        pass

    root = ET.fromstring((tmp_path / "a.svg").read_text())  # noqa: S314
    title, description = root.find(f"{SVG}title"), root.find(f"{SVG}desc")
    assert title is not None
    assert title.text == "a < b & c"
    assert description is not None
    assert description.text == "\\1 <x>"


def test_picture_that_cannot_be_written_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")

    with (
        pytest.raises(InputError, match=r"file/a\.svg: cannot write"),
        theme.picture(tmp_path / "file" / "a.svg", theme.Words("a", "b")),
    ):
        pass


def test_picture_that_fails_leaves_nothing(tmp_path: Path) -> None:
    def fail() -> None:
        with theme.picture(tmp_path / "a.svg", theme.Words("a", "b")):
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()

    assert list(tmp_path.iterdir()) == []
