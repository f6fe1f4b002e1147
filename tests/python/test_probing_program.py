"""Programs of probing moves: what a controller logs of them is imported as what was asked for."""

import re
import shlex
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch.campaign import Axis, Campaign, InputPath, Touches, read_campaign
from skiplatch.cli import group
from skiplatch.importing.grbl import read_grbl
from skiplatch.probing_program import FILES, KINDS, Programs, programs
from skiplatch.probing_touches import as_logged

N = 24
REACH_MM = (-40.0, 100.0)


def asked(axis: Axis = Axis.X, *, senses: tuple[float, ...] = (1.0, -1.0)) -> Touches:
    """Touches of a surface for each sense, at two feeds and approaches."""
    turn = np.arange(N)
    sign = np.array(senses)[turn % len(senses)]
    return Touches.from_columns(
        touch=turn,
        path=np.full(N, InputPath.PLC),
        axis=np.full(N, axis),
        sign=sign,
        feed_mm_min=np.array([60.0, 240.0])[turn // 2 % 2],
        approach_mm=np.array([2.0, 5.0])[turn // 4 % 2],
        position_mm=np.where(sign > 0.0, 12.5, -7.25),
    )


def made_of(
    kind: str, touches: Touches, reach_mm: tuple[float, float] = REACH_MM, stem: str = "next"
) -> Programs:
    return programs(kind, touches, [1.5] * len(touches), reach_mm, stem, Path("mill"))


def texts_of(
    kind: str, touches: Touches, reach_mm: tuple[float, float] = REACH_MM
) -> dict[str, str]:
    """Give the programs alone, by their names without ending."""
    ending = FILES[kind][0]
    texts = made_of(kind, touches, reach_mm).texts.items()
    return {name.removesuffix(ending): text for name, text in texts if name.endswith(ending)}


class Controller:
    """Carries out a program line by line: moves of one axis, and a surface for each sense."""

    def __init__(self, delay_ms: float = 3.0, *, off_mm: float = 0.0) -> None:
        self.delay_ms = delay_ms
        self.off_mm = off_mm
        self.at: dict[str, float] = {}

    def surface(self, sense: int) -> float:
        return self.off_mm + (12.5 if sense > 0 else -7.25)

    def probe(self, axis: str, target: float, feed: float) -> float:
        """Go towards the target; give where the surface was latched, late by the delay."""
        sense = 1 if target > self.at[axis] else -1
        latched = self.surface(sense) + sense * feed / 60.0 * self.delay_ms / 1e3
        assert min(self.at[axis], target) < latched < max(self.at[axis], target)
        self.at[axis] = latched
        return latched

    def probe_from_here(self, axis: str, way: float, feed: float) -> float:
        """Go that way, the first time from where the operator has set the probe."""
        self.at.setdefault(axis, self.surface(1 if way > 0 else -1) - 0.8 * way)
        return self.probe(axis, self.at[axis] + way, feed)

    def touches(self, text: str) -> list[tuple[str, float | None]]:
        """Give each line and what was latched in it."""
        done: list[tuple[str, float | None]] = []
        for line in text.splitlines():
            latched = None
            if move := re.match(r"(G91 )?G38\.2 ([XYZ])(\S+) F(\S+)$", line):
                go = self.probe_from_here if move[1] else self.probe
                latched = go(move[2], float(move[3]), float(move[4]))
            elif move := re.match(r"(?:G90 G53 )?G[01] ([XYZ])(\S+)(?: F\S+)?$", line):
                self.at[move[1]] = float(move[2])
            done.append((line, latched))
            check = re.match(r"o1 if \[ABS\[#5061 - \[(\S+)\]\] LE (\S+)\]$", line)
            if check and abs(self.at["X"] - float(check[1])) > float(check[2]):
                break
        return done


def linuxcnc_log(folder: Path) -> list[str]:
    texts = texts_of("linuxcnc", asked())
    for name, text in texts.items():
        (folder / f"{name}.ngc").write_text(text)
        done = Controller().touches(text)
        opened = [line for line, _ in done].index(f"(PROBEOPEN {name}.txt)")
        rows = [f"{x:f} 30.0 -5.0 0.0 0.0 0.0 0.0 0.0 0.0\n" for _, x in done[opened:] if x]
        (folder / f"{name}.txt").write_text("".join(rows))
    return command_in(folder, made_of("linuxcnc", asked()).then)


def grbl_log(folder: Path) -> list[str]:
    said = "Grbl 1.1h ['$' for help]\n"
    for text in texts_of("grbl", asked()).values():
        said += ">>> $J=G91 X-3 F600\nok\n"  # the operator, to the next surface
        for line, x in Controller().touches(text):
            said += f">>> {line}\n"
            said += f"[PRB:{x:.3f},30.000,-5.000:1]\nok\n" if x is not None else "ok\n"
    (folder / "next.log").write_text(said)
    return command_in(folder, made_of("grbl", asked()).then)


def command_in(folder: Path, then: str) -> list[str]:
    """Give the words of an import behind ``skiplatch import``, its files in the folder."""
    words = shlex.split(then)
    assert words[:2] == ["skiplatch", "import"]
    assert words[-4:] == ["--nominal", "mill/nominal.toml", "-o", "made"]
    is_file = re.compile(r"next.*\.")
    return [str(folder / w) if is_file.match(w) else w for w in words[2:-4]]


class Heidenhain(Controller):
    """Carries out Klartext as far as it is written: cycle 4, jumps, Q parameters, and FN 16."""

    def __init__(self, texts: Mapping[str, str], *, missed: int = 0, off_mm: float = 0.0) -> None:
        super().__init__(off_mm=off_mm)
        self.texts = texts
        self.missed = missed
        self.values: dict[str, str | float] = {}
        self.direction: dict[str, int] = {}
        self.printed = ""
        self.probed = 0

    def carry_out(self, program: str) -> None:
        """Run a program."""
        blocks = self.texts[program].splitlines()
        texts = [block.split(" ", 1)[1] for block in blocks]
        assert [block.split(" ", 1)[0] for block in blocks] == list(map(str, range(len(blocks))))
        self.at, at, back = {}, 0, -1
        while texts[at] != "M30":
            if jump := re.match(r"FN (9|11|12): IF \+(\S+) (\w+) (\S+) GOTO (LBL \d)$", texts[at]):
                value = float(self.values.get(jump[2], 0.0))
                other = float(jump[4])
                holds = {"9": value == other, "11": value > other, "12": value < other}[jump[1]]
                at = texts.index(jump[5]) if holds else at + 1
            elif texts[at] == "CALL LBL 1":
                at, back = texts.index("LBL 1"), at + 1
            elif texts[at] == "LBL 0":
                at = back
            else:
                self.block(texts[at])
                at += 1

    def block(self, text: str) -> None:
        if move := re.match(r"L ([XYZ])(\S+) R0 FMAX$", text):
            self.at[move[1]] = float(move[2])
        elif text.startswith("TCH PROBE 4.2"):
            ways = {axis: int(way) for axis, way in re.findall(r"I([XYZ])(\S+)", text)}
            self.direction = {axis: way for axis, way in ways.items() if way}
        elif measure := re.match(r"TCH PROBE 4\.3 ABST\+(\S+) F(\S+) MB\S+ ", text):
            ((axis, way),) = self.direction.items()
            self.measure(axis, way * float(measure[1]), float(measure[2]))
        elif assigned := re.match(r"(Q\w+) = (.*)$", text):
            value = assigned[2]
            known = self.values.get(value, value.strip('"'))
            self.values[assigned[1]] = known if assigned[1] == "QS1" else float(known)
        elif printing := re.match(r"FN 16: F-PRINT TNC:\\(.*)/TNC:\\next\.txt$", text):
            self.print(self.texts[printing[1]])

    def measure(self, axis: str, way: float, feed: float) -> None:
        """Probe, or go to the end of the way where nothing is met."""
        self.probed += 1
        if self.probed == self.missed:
            self.at[axis] = self.at.get(axis, 0.0) + way
            self.values["Q4"] = -1.0
        else:
            self.probe_from_here(axis, way, feed)
        self.values |= {f"Q{i}": self.at.get(a, 0.0) for i, a in enumerate("XYZ", 1)}

    def print(self, mask: str) -> None:
        appends = mask.startswith("M_APPEND;")
        form, names = re.findall(r'"(.*)"(.*);', mask)[0]
        values = tuple(self.values[name] for name in names.split(",") if name)
        text = form.replace("%S", "%s").replace("lf", "f") % values + "\n"
        self.printed = self.printed + text if appends else text


def heidenhain_log(folder: Path, missed: int = 0) -> list[str]:
    made = made_of("heidenhain", asked())
    control = Heidenhain(made.texts, missed=missed)
    for name in texts_of("heidenhain", asked()):
        control.carry_out(f"{name}.h")
    (folder / "next.txt").write_text(control.printed)
    return command_in(folder, made.then)


LOGS: dict[str, Callable[[Path], list[str]]] = {
    "linuxcnc": linuxcnc_log,
    "grbl": grbl_log,
    "heidenhain": heidenhain_log,
}


def imported(words: list[str], folder: Path) -> Campaign:
    out = folder / "made"
    result = CliRunner().invoke(group, ["import", *words, "-o", str(out)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return read_campaign(out)


def slope_ms(touches: Touches) -> float:
    fit = np.polyfit(touches.feed_mm_min / 60.0, touches.deviation_um, 1)
    return float(fit[0])


@pytest.mark.parametrize("kind", list(LOGS))
def test_log_of_the_program_is_what_was_asked_for(kind: str, tmp_path: Path) -> None:
    touches = asked()
    order = np.argsort(-touches.sign, kind="stable")  # surface by surface

    made = imported(LOGS[kind](tmp_path), tmp_path).touches

    assert made.path.tolist() == touches.path.tolist()
    assert made.axis.tolist() == [Axis.X] * N
    assert made.sign.tolist() == touches.sign[order].tolist()
    assert made.feed_mm_min.tolist() == touches.feed_mm_min[order].tolist()
    assert made.approach_mm == pytest.approx(touches.approach_mm[order], abs=0.02)
    assert made.position_mm == pytest.approx(touches.position_mm[order], abs=0.02)
    assert slope_ms(made) == pytest.approx(3.0, abs=0.05)


def as_sent(text: str) -> str:
    """As senders write it that take comments and spaces out."""
    lines = (line for line in text.splitlines() if not line.startswith(">>> ;"))
    return "".join(f"{line.replace(' ', '').replace('>>>', '>>> ')}\n" for line in lines)


def ahead(text: str) -> str:
    """As senders do that send a program before the controller answers."""
    start, *lines = text.splitlines()
    lines.sort(key=lambda line: not line.startswith(">>>"))
    return "\n".join([start, *lines]) + "\n"


@pytest.mark.parametrize("sender", [str, as_sent, ahead])
def test_touches_of_grbl_that_find_a_surface_are_left_out(
    sender: Callable[[str], str], tmp_path: Path
) -> None:
    words = grbl_log(tmp_path)
    log = tmp_path / "next.log"
    missed = ">>> G21 G94\nok\n>>> G91 G38.2 X10 F60\n[PRB:1.000,30.000,-5.000:0]\nALARM:5\n"
    log.write_text(sender(log.read_text()) + missed)

    found = read_grbl(log, None)
    made = imported(words, tmp_path).touches

    assert len(made) == N
    assert not made.missed.any()
    (said,) = (line for line in found.known if "find a surface" in line)
    assert said.startswith("3 touches by which programs of 'design' find a surface, which are left")


@pytest.mark.parametrize(
    "then", ["G90\nok\nG90 G53 G0 X1\nok\n", "G90\nok\nG90 G53 G1 X1 F61\nok\n", "G0 X-2\nok\n"]
)
def test_a_first_touch_of_another_program_of_grbl_stays(then: str, tmp_path: Path) -> None:
    touch = "[PRB:4.000,30.000,-5.000:1]\nok\n"
    first = f"G21 G94\nok\nG91 G38.2 X10 F60\n{touch}"
    (tmp_path / "own.log").write_text(f"{first}{then}G91 G38.2 X10 F60\n{touch}")

    assert len(read_grbl(tmp_path / "own.log", None).touches) == 2


def test_klipper_makes_each_touch_a_series_of_one(tmp_path: Path) -> None:
    odd = np.array([205.0, 4.0])[np.arange(N) // 2 % 2]  # 3.417 and 0.067 mm/s
    touches = as_logged("klipper", replace(asked(Axis.Z, senses=(-1.0,)), feed_mm_min=odd))
    said, at = "", 0.0
    for line in texts_of("klipper", touches)["next"].splitlines():
        if move := re.match(r"G1 Z(\S+)", line):
            at = float(move[1])
        elif call := re.match(r"PROBE_ACCURACY PROBE_SPEED=(\S+) SAMPLES=1 \w+=(\S+)$", line):
            speed, retract = float(call[1]), float(call[2])
            options = f"samples=1 retract={retract:.3f} speed={speed:.1f} lift_speed=5.0"
            said += f"PROBE_ACCURACY at X:10.000 Y:20.000 Z:{at:.3f} ({options})\n"
            z = -7.25 - speed * 3.0 / 1e3
            said += f"probe at 10.000,20.000 is z={z:.6f}\n"
    (tmp_path / "klippy.log").write_text(said)

    made = imported(["klipper", str(tmp_path / "klippy.log")], tmp_path).touches

    assert set(touches.feed_mm_min) == {204.0, 6.0}
    assert made.feed_mm_min == pytest.approx(touches.feed_mm_min)
    assert made.approach_mm == pytest.approx(touches.approach_mm, abs=0.02)
    assert slope_ms(made) == pytest.approx(3.0, abs=0.05)


@pytest.mark.parametrize("kind", list(LOGS))
def test_other_controllers_make_every_feed(kind: str) -> None:
    odd = replace(asked(), feed_mm_min=np.full(N, 205.0))

    assert as_logged(kind, odd) is odd


@pytest.mark.parametrize("kind", list(LOGS))
def test_each_surface_has_a_program_that_keeps_to_its_side(kind: str) -> None:
    """Of a boss, too: no rapid move leads through it, wherever the probe was left."""
    plus, minus = (touched_from_outside(sense) for sense in (1.0, -1.0))
    texts = texts_of(kind, joined(plus, minus), (-60.0, 60.0))

    assert list(texts) == ["next-1", "next-2"]
    assert "; surface X- at 40 mm, program 2 of 2\n" in texts["next-2"]
    for text, touches in zip(texts.values(), (plus, minus), strict=True):
        sense = touches.sign[0]
        rapid = re.findall(r"(?:G0|G1|\d L) ([XYZ])(\S+)", text)
        assert {axis for axis, _ in rapid} == {"X"}
        assert all(sense * float(x) < sense * touches.position_mm[0] for _, x in rapid)
        first = re.search(r"G91 G38\.2|TCH PROBE|G0|\d L ", text)
        assert first
        assert first[0] in ("G91 G38.2", "TCH PROBE")


def touched_from_outside(sense: float) -> Touches:
    touches = asked(senses=(sense,))
    return replace(touches, position_mm=np.full(N, -40.0 * sense))


def joined(one: Touches, other: Touches) -> Touches:
    both = {name: np.concatenate([c, other.columns()[name]]) for name, c in one.columns().items()}
    return Touches.from_columns(**both)


def test_a_surface_of_its_own_needs_no_number() -> None:
    assert list(texts_of("grbl", asked(senses=(1.0,)))) == ["next"]


@pytest.mark.parametrize("kind", ["linuxcnc", "heidenhain"])
def test_a_surface_that_is_elsewhere_is_left_alone(kind: str) -> None:
    """A tool offset that is not active shows in the touch that finds the surface."""
    made = made_of(kind, asked(senses=(1.0,)))
    if kind == "linuxcnc":
        done = Controller(off_mm=5.0).touches(made.texts["next.ngc"])
        assert not any(line.startswith("G0") for line, _ in done)
    else:
        control = Heidenhain(made.texts, off_mm=5.0)
        control.carry_out("next.h")
        assert control.probed == 1
        assert "F60 MB1.000" in made.texts["next.h"]  # nor is the way back from it known


def test_linuxcnc_sets_no_offset_of_its_own() -> None:
    (text,) = texts_of("linuxcnc", asked(senses=(1.0,))).values()

    code = [line for line in text.splitlines() if not line.startswith(";")]
    assert not re.search(r"G(49|43|5[4-9]|92)", "\n".join(code))
    assert "with the same G54 to G59.3, G92 and tool offset (G43)" in text
    assert text.index("(PROBEOPEN next.txt)") > text.index("G91 G38.2")
    assert not re.search(r"^M(2|30)$", text, re.MULTILINE)  # they select G54
    assert text.splitlines()[0] == text.splitlines()[-1] == "%"


def test_heidenhain_logs_a_miss_as_one(tmp_path: Path) -> None:
    made = imported(heidenhain_log(tmp_path, missed=4), tmp_path).touches

    assert np.flatnonzero(made.missed).tolist() == [2]  # the first measures nothing but the place
    assert np.isnan(made.deviation_um[2])
    assert abs(np.delete(made.deviation_um, 2)).max() < 20.0


def test_heidenhain_ends_where_it_finds_no_surface() -> None:
    made = made_of("heidenhain", asked(senses=(1.0,)))
    control = Heidenhain(made.texts, missed=1)
    control.carry_out("next.h")

    assert control.probed == 1


@pytest.mark.parametrize("stem", ["pa(ren)", "ä b", "a.b", "a!", ""])
def test_a_name_that_no_controller_holds_is_refused(stem: str) -> None:
    with pytest.raises(ValueError, match="expected a name of A-Z, a-z, 0-9, _ and - alone"):
        made_of("grbl", asked(), stem=stem)


def test_comments_are_plain_and_the_command_is_quoted() -> None:
    made = programs("grbl", asked(), [1.5] * N, REACH_MM, "next", Path("Fräse (1)!?~"))

    assert shlex.split(made.then)[-3] == "Fräse (1)!?~/nominal.toml"
    assert all(text.isascii() and not set(text) & set("!?~") for text in made.texts.values())


def test_touches_of_both_paths_are_refused() -> None:
    mixed = replace(asked(), path=np.arange(N, dtype=np.int8) % 2)

    with pytest.raises(ValueError, match="touches of one path"):
        made_of("grbl", mixed)


def test_moves_stay_within_reach() -> None:
    texts = texts_of("linuxcnc", asked(), (-8.0, 13.0))

    moves = re.findall(r"^(?:G0|G38\.2) X(-?[\d.]+)", "".join(texts.values()), re.MULTILINE)
    places = [float(value) for value in moves]
    assert min(places) == -8.0
    assert max(places) == 13.0


@pytest.mark.parametrize("kind", list(LOGS))
@pytest.mark.parametrize(("room", "way"), [(0.5, 0.5), (3.0, 3.0), (25.0, 10.0)])
def test_no_way_to_a_surface_leads_out_of_reach(kind: str, room: float, way: float) -> None:
    """Wherever in front of the surface the probe is set; nor does one lead out backwards."""
    texts = texts_of(kind, asked(), (-7.25 - room, 12.5 + room))

    for text in texts.values():
        finding, *_ = re.findall(r"(?:G91 G38\.2 X|ABST)(\S+)", text)
        assert abs(float(finding)) == way
        assert f"nearer than {way:g} mm" in text


def test_heidenhain_draws_back_no_farther_than_the_starts() -> None:
    (text,) = texts_of("heidenhain", asked(senses=(1.0,)), (12.2, 100.0)).values()

    backs = [float(back) for back in re.findall(r" MB(\S+)", text)]
    assert max(backs) == pytest.approx(0.3)


@pytest.mark.parametrize(("reach_mm", "end"), [((-40.0, 12.51), "max"), ((-7.26, 100.0), "min")])
def test_a_surface_at_the_end_of_the_axis_is_refused(
    reach_mm: tuple[float, float], end: str
) -> None:
    message = rf"X\S at \S+ mm: {end}_mm of \[axis\] is 0.01 mm behind it, expected 0.1 mm or more"

    with pytest.raises(ValueError, match=message):
        made_of("grbl", asked(), reach_mm)


@pytest.mark.parametrize(
    ("kind", "touches", "message"),
    [
        ("klipper", asked(), "along Z from above only"),
        ("grbl", asked(Axis.A), "touch 0: a program needs linear axis"),
        ("grbl", asked(senses=(np.nan,)), "touch 0: a program needs linear axis"),
    ],
)
def test_what_a_controller_cannot_do_is_refused(kind: str, touches: Touches, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        made_of(kind, touches)


def test_log_of_every_kind_is_tried() -> None:
    assert set(KINDS) == {"klipper", *LOGS}


@pytest.mark.parametrize("kind", list(LOGS))
def test_no_rapid_move_goes_where_no_slow_one_went(kind: str) -> None:
    touches = asked(senses=(1.0,))
    ways = np.where(np.arange(N) == N - 1, 14.0, 4.0)
    (text,) = texts_of(kind, replace(touches, approach_mm=ways), REACH_MM).values()

    found = re.findall(r"(?:G0|G1|\d L) X(\S+)(?: R0)?( F[\d]+)?", text)
    moves = [(float(x), feed) for x, feed in found]
    assert moves[0][1]
    assert all(x >= moves[0][0] for x, _ in moves)
    assert f"the probe is drawn back to X{moves[0][0]:.3f}, slowly" in text
