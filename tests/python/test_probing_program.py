"""Programs of probing moves: what a controller logs of them is imported as what was asked for."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch.campaign import Axis, Campaign, InputPath, Touches, read_campaign
from skiplatch.cli import group
from skiplatch.probing_program import KINDS, LOGGED, program

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


def text_of(kind: str, touches: Touches, reach_mm: tuple[float, float] = REACH_MM) -> str:
    return next(iter(files_of(kind, touches, reach_mm).values()))


def files_of(
    kind: str, touches: Touches, reach_mm: tuple[float, float] = REACH_MM
) -> dict[str, str]:
    return program(kind, touches, [1.5] * len(touches), reach_mm, "next")


class Controller:
    """Carries out a program line by line: moves of one axis, and a surface for each sense."""

    def __init__(self, delay_ms: float) -> None:
        self.delay_ms = delay_ms
        self.at: dict[str, float] = {}

    def surface(self, sense: int) -> float:
        return 12.5 if sense > 0 else -7.25

    def probe(self, axis: str, target: float, feed: float) -> float:
        """Go towards the target; give where the surface was latched, late by the delay."""
        sense = 1 if target > self.at[axis] else -1
        latched = self.surface(sense) + sense * feed / 60.0 * self.delay_ms / 1e3
        assert min(self.at[axis], target) < latched < max(self.at[axis], target)
        self.at[axis] = latched
        return latched

    def touches(self, text: str) -> list[tuple[str, float | None]]:
        """Give each line and what was latched in it."""
        done: list[tuple[str, float | None]] = []
        for line in text.splitlines():
            latched = None
            if move := re.match(r"(G91 )?G38\.2 ([XYZ])(\S+) F(\S+)$", line):
                from_here = self.at[move[2]] if move[1] else 0.0
                latched = self.probe(move[2], from_here + float(move[3]), float(move[4]))
            elif move := re.match(r"(?:G90 G53 )?G0 ([XYZ])(\S+)$", line):
                self.at[move[1]] = float(move[2])
            done.append((line, latched))
        return done


def linuxcnc_log(text: str, folder: Path) -> list[str]:
    (folder / "next.ngc").write_text(text)
    rows = [z for _, z in Controller(3.0).touches(text) if z is not None]
    lines = [f"{x:f} 30.0 -5.0 0.0 0.0 0.0 0.0 0.0 0.0" for x in rows]
    (folder / "next.txt").write_text("\n".join(lines) + "\n")
    return ["linuxcnc", str(folder / "next.txt"), "--program", str(folder / "next.ngc")]


def grbl_log(text: str, folder: Path) -> list[str]:
    said = "Grbl 1.1h ['$' for help]\n"
    for line, x in Controller(3.0).touches(text):
        said += f">>> {line}\n"
        said += f"[PRB:{x:.3f},30.000,-5.000:1]\nok\n" if x is not None else "ok\n"
    (folder / "next.log").write_text(said)
    return ["grbl", str(folder / "next.log")]


class Heidenhain(Controller):
    """Carries out Klartext as far as it is written: cycle 4, Q parameters, and FN 16."""

    def __init__(self, files: dict[str, str]) -> None:
        super().__init__(3.0)
        self.files = files
        self.values: dict[str, str | float] = {}
        self.direction: dict[str, int] = {}
        self.printed = ""

    def carry_out(self) -> str:
        """Run the program and give what FN 16 has printed."""
        for number, block in enumerate(self.files["next.h"].splitlines()):
            count, text = block.split(" ", 1)
            assert int(count) == number
            self.block(text)
        return self.printed

    def block(self, text: str) -> None:
        if move := re.match(r"L ([XYZ])(\S+) R0 FMAX$", text):
            self.at[move[1]] = float(move[2])
        elif text.startswith("TCH PROBE 4.2"):
            ways = {axis: int(way) for axis, way in re.findall(r"I([XYZ])(\S+)", text)}
            self.direction = {axis: way for axis, way in ways.items() if way}
        elif measure := re.match(r"TCH PROBE 4\.3 ABST\+(\S+) F(\S+) MB\S+ ", text):
            ((axis, way),) = self.direction.items()
            target = self.at[axis] + way * float(measure[1])
            self.probe(axis, target, float(measure[2]))
            self.values |= {f"Q{i}": self.at.get(a, 0.0) for i, a in enumerate("XYZ", 1)}
        elif assigned := re.match(r"(Q\w+) = (.*)$", text):
            value = assigned[2]
            known = self.values.get(value, value.strip('"'))
            self.values[assigned[1]] = known if assigned[1] == "QS1" else float(known)
        elif printing := re.match(r"FN 16: F-PRINT TNC:\\(.*)/TNC:\\next\.txt$", text):
            self.print(self.files[printing[1]])

    def print(self, mask: str) -> None:
        appends = mask.startswith("M_APPEND;")
        form, names = re.findall(r'"(.*)"(.*);', mask)[0]
        values = tuple(self.values[name] for name in names.split(",") if name)
        text = form.replace("%S", "%s").replace("lf", "f") % values + "\n"
        self.printed = self.printed + text if appends else text


def heidenhain_log(folder: Path) -> list[str]:
    files = files_of("heidenhain", asked())
    (folder / "next.txt").write_text(Heidenhain(files).carry_out())
    maps = [word for name in LOGGED for word in ("--map", f"{name}={name}")]
    assert f"csv next.txt {' '.join(maps)} -o made" in files["next.h"]
    return ["csv", str(folder / "next.txt"), *maps]


LOGS: dict[str, Callable[[str, Path], list[str]]] = {
    "linuxcnc": linuxcnc_log,
    "grbl": grbl_log,
    "heidenhain": lambda _, folder: heidenhain_log(folder),
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

    made = imported(LOGS[kind](text_of(kind, touches), tmp_path), tmp_path).touches

    assert made.axis.tolist() == [Axis.X] * N
    assert made.sign.tolist() == touches.sign[order].tolist()
    assert made.feed_mm_min.tolist() == touches.feed_mm_min[order].tolist()
    assert made.approach_mm == pytest.approx(touches.approach_mm[order], abs=0.02)
    assert made.position_mm == pytest.approx(touches.position_mm[order], abs=0.02)
    assert slope_ms(made) == pytest.approx(3.0, abs=0.05)


def test_klipper_makes_each_touch_a_series_of_one(tmp_path: Path) -> None:
    touches = asked(Axis.Z, senses=(-1.0,))
    said, at = "", 0.0
    for line in text_of("klipper", touches).splitlines():
        if move := re.match(r"G1 Z(\S+)", line):
            at = float(move[1])
        elif call := re.match(r"PROBE_ACCURACY PROBE_SPEED=(\S+) SAMPLES=1 \w+=(\S+)$", line):
            speed, retract = float(call[1]), float(call[2])
            options = f"samples=1 retract={retract:.3f} speed={speed:.1f} lift_speed=5.0"
            said += f"PROBE_ACCURACY at X:10.000 Y:20.000 Z:{at:.3f} ({options})\n"
            z = -7.25 - speed * 3.0 / 1e3
            said += f"probe: at 10.000,20.000 bed will contact at z={z:.6f}\n"
    (tmp_path / "klippy.log").write_text(said)

    made = imported(["klipper", str(tmp_path / "klippy.log")], tmp_path).touches

    assert made.feed_mm_min == pytest.approx(touches.feed_mm_min)
    assert made.approach_mm == pytest.approx(touches.approach_mm, abs=0.02)
    assert slope_ms(made) == pytest.approx(3.0, abs=0.05)


def test_program_stops_before_each_other_surface_only() -> None:
    text = text_of("linuxcnc", asked())

    assert text.count("\nM0\n") == 1
    assert text.count("G38.2") == N
    assert text.index("(PROBEOPEN next.txt)") < text.index("G38.2")
    assert text.rstrip().endswith("(PROBECLOSE)\nM2")


def test_moves_stay_within_reach() -> None:
    text = text_of("linuxcnc", asked(), (-8.0, 13.0))

    places = [float(value) for value in re.findall(r"X(-?[\d.]+)", text)]
    assert min(places) == -8.0
    assert max(places) == 13.0


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
        text_of(kind, touches)


def test_log_of_every_kind_is_tried() -> None:
    assert set(KINDS) == {"klipper", *LOGS}
