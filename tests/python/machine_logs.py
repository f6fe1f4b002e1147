"""Ten logs, two of each kind, of plain models of machines: with their noise, chatter and one fault.

Each is as its program prints it: terminals' marks and times, settings, alarms, typing errors.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.units import S_PER_MIN


@dataclass(frozen=True, slots=True)
class MachineLog:
    """A log, how it is imported, and what is true of the machine.

    Attributes:
        files: Text by name; the first is the log.
        options: Of ``skiplatch import KIND LOG``.
        touches: How many there are.
        drift_um: How far the surface goes until the last touch, along the approach.
        verdicts: What a diagnosis may say.
        effects: What can be wrong with it: one of them has to be named, or listed beside the name.
    """

    kind: str
    files: dict[str, str]
    touches: int
    options: tuple[str, ...] = ()
    drift_um: float = 0.0
    verdicts: tuple[str, ...] = ("no_gap", "undecided")
    effects: tuple[str, ...] = ()

    def written(self, folder: Path) -> list[str]:
        """Write it; give the words of the import."""
        for name, text in self.files.items():
            (folder / name).write_text(text)
        paths = [str(folder / word) if word in self.files else word for word in self.options]
        return [self.kind, str(folder / next(iter(self.files))), *paths]


HEAT = ("thermal_drift",)
DRIFTS = ("unknown", "undecided", "partly_explained", "explained")


def _clock(seconds: float) -> str:
    hours, rest = divmod(seconds, 3600)
    return f"{int(hours):02d}:{int(rest // 60):02d}:{rest % 60:06.3f}"


def _stepped(value: float, step: float) -> float:
    return round(value / step) * step


def linuxcnc_debounced() -> MachineLog:
    """A plate touched at three feeds; the input is debounced by 5 servo periods of 1 ms."""
    rng = np.random.default_rng(11)
    feeds = (60, 180, 540)
    moves = "".join(f"  G38.2 Z-5 F{f}\n  G0 Z#<_clear>\n" for f in feeds)
    program = (
        "%\n( touch plate, G54 )\nG21 G90 G94 G17\nM5\nT99 M6 G43 H99\n#<_clear> = 5.\n"
        "(PROBEOPEN /home/cnc/nc_files/plate.txt) ; 3 feeds\nG0 Z[#<_clear>]\nG0 X12.5 Y-3\n"
        f"#<i> = 0\no100 while [#<i> LT 12]\n{moves}  #<i> = [#<i> + 1]\no100 endwhile\n"
        "(PROBECLOSE)\nM2\n%\n"
    )
    rows = ""
    for feed in feeds * 12:
        late_s = 0.005 + rng.uniform(0.0, 0.001)
        z = -1.237 - feed / S_PER_MIN * late_s + rng.normal(0.0, 0.0008)
        rows += f"12.500000 -3.000000 {z:f}" + " 0.000000" * 6 + " \n"
    return MachineLog(
        "linuxcnc",
        {"plate.txt": rows, "plate.ngc": program},
        touches=36,
        options=("--program", "plate.ngc"),
        verdicts=("explained", "partly_explained", "undecided"),
        effects=("input_image_delay", "input_filter", "trigger_delay"),
    )


def linuxcnc_inches() -> MachineLog:
    """A slot from within, both senses, in inches; sound."""
    rng = np.random.default_rng(12)
    program, rows = "; slot width\nG20 G91 G17 G40\nG54\n(PROBEOPEN slot.txt)\n", ""
    for feed in (2.0, 8.0) * 10:
        for sense, side in ((1, "right"), (-1, "left")):
            program += f"G38.3 X{sense * 0.75:.4f} F{feed} ({side})\nG90 G1 X0 F40\nG91\n"
            late_in = feed / S_PER_MIN * rng.uniform(0.0, 0.001)
            x = sense * (0.38712 + late_in + rng.normal(0.0, 0.00003))
            rows += f"{x:f} 0.000000 -0.250000" + " 0.000000" * 6 + "\n"
    files = {"slot.txt": rows, "slot.ngc": program + "(PROBECLOSE)\nm30\n"}
    return MachineLog("linuxcnc", files, touches=40, options=("--program", "slot.ngc"))


def fluidnc_warming() -> MachineLog:
    """A router by telnet with CRLF and times; Z sinks by 36 µm in an hour as the spindle warms."""
    rng = np.random.default_rng(21)
    settings = "$0=3.000|$10=1|$100=800.000|$102=400.000|$112=1500.000|$122=120.000|$132=100.000"
    begin = (
        "[MSG:INFO: FluidNC v3.7.8 https://github.com/bdring/FluidNC]|[MSG:INFO: Axis count 3]|"
        "[MSG:INFO: Probe gpio.36:low]|Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]|$G|"
        f"[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]|ok|$$|{settings}|ok|$H|[MSG:Homed:Z]|ok|"
        "M3 S10000|ok"
    )
    now_s = 33_124.0
    text = "".join(f"{_clock(now_s)} {line}\r\n" for line in begin.split("|"))
    began_s, sunk_mm = now_s, 0.0
    for number in range(60):
        feed = (50, 200)[number % 2]
        now_s += rng.uniform(55.0, 62.0) + 12.4 / feed * S_PER_MIN
        sunk_mm = 0.040 * -np.expm1(-(now_s - began_s) / 1500.0)
        z = _stepped(-22.431 - sunk_mm + rng.normal(0.0, 0.0015), 1 / 400)
        lines = ["G90 G0 Z-10", "ok", f"G38.2 Z-40 F{feed}"]
        lines += [f"<Run|MPos:-200.000,-150.000,{z + 3:.3f}|FS:{feed},10000>"] * (number % 7 == 3)
        lines += [f"[PRB:-200.000,-150.000,{z:.3f}:1]", "ok"]
        text += "".join(f"{_clock(now_s)} {line}\r\n" for line in lines)
    return MachineLog(
        "grbl", {"telnet.log": text}, touches=60, drift_um=1e3 * sunk_mm, verdicts=DRIFTS
    )


def grbl_alarms() -> MachineLog:
    """Two faces of a block in UGS, with an alarm, a missed touch and typing errors; sound."""
    rng = np.random.default_rng(22)
    text = (
        "**** Connected to /dev/ttyUSB0 @ 115200 baud ****\n\nGrbl 1.1h ['$' for help]\n>>> $$\n"
        "$6 = 0    (Invert probe pin, boolean)\n$100 = 250.000    (X-axis travel resolution)\n"
        "$101 = 250.000    (Y-axis travel resolution)\n$120 = 150.000    (X-axis acceleration)\n"
        "$121 = 150.000    (Y-axis acceleration)\nok\n>>> $X\n[MSG:Caution: Unlocked]\nok\n"
        ">>> G21\nok\n>>> G91\nok\n>>> G38.2 X5 F50\nALARM:5\nProbe fail. Probe did not contact\n"
        "[PRB:0.000,0.000,0.000:0]\n>>> $X\n[MSG:Caution: Unlocked]\nok\n>>> G38.2 X\nerror:2\n"
    )
    for axis, place, sense in (("X", 31.272, 1), ("Y", -18.804, -1)):
        for number in range(16):
            feed = (40, 120, 300)[number % 3]
            at = _stepped(place + rng.normal(0.0, 0.002), 1 / 250)
            where = f"{at:.3f},0.000" if axis == "X" else f"10.000,{at:.3f}"
            text += f">>> G38.2 {axis}{sense * 30} F{feed}\n[PRB:{where},-4.000:1]\nok\n"
            text += f">>> G0 {axis}{-sense * 6}\nok\n"
    return MachineLog("grbl", {"console.log": text}, touches=33)


def _klipper_series(zs: NDArray[np.float64]) -> str:
    return (
        f"probe accuracy results: maximum {zs.max():f}, minimum {zs.min():f}, "
        f"range {np.ptp(zs):f}, average {zs.mean():f}, median {np.median(zs):f}, "
        f"standard deviation {zs.std():f}"
    )


def klippy_heating() -> MachineLog:
    """klippy.log while the bed goes from 25 to 70 °C, and Z with it by 1.6 µm/K."""
    rng = np.random.default_rng(31)
    text = (
        "Starting Klippy...\nGit version: 'v0.12.0-85-gd785b396'\n===== Config file =====\n"
        "[printer]\nkinematics = corexy\nmax_z_velocity = 15\nmax_z_accel = 350\n\n[stepper_z]\n"
        "microsteps = 16\nrotation_distance = 8\nendstop_pin = probe:z_virtual_endstop\n\n[probe]\n"
        "pin = ^PB7\nspeed = 5.0\n\n[heater_bed]\nheater_pin = PA1\n\n=======================\n"
        "Configured MCU 'mcu' (1024 moves)\n"
    )
    many_mcus = "".join(f" mcu{i}: mcu_awake=0.002 send_seq=1010 freq=180000229" for i in range(3))
    now_s, bed_c = 130.0, 25.0
    stats = "Stats {:.1f}: gcodein=0 {} heater_bed: target=70 temp={:.1f} pwm=0.421 sysload=0.12\n"
    for series in range(8):
        now_s += 30.0
        text += "PROBE_ACCURACY at X:125.000 Y:125.000 Z:5.000 (samples=10 retract=2.000 speed=5.0 "
        text += "lift_speed=5.0)\n"
        zs = np.empty(10)
        for number in range(10):
            now_s += 1.0
            bed_c = 25.0 - 45.0 * np.expm1(-(10 * series + number) / 20.0)
            zs[number] = _stepped(1.235 + 0.0016 * (bed_c - 25.0) + rng.normal(0, 0.0012), 0.0025)
            text += stats.format(now_s, many_mcus, bed_c)
            text += f"probe at 125.000,125.000 is z={zs[number]:f}\n"
        text += _klipper_series(zs) + "\n"
    drift_um = -1.6 * (bed_c - 25.0)  # upwards: latched before the place of the surface
    return MachineLog(
        "klipper",
        {"klippy.log": text},
        touches=80,
        drift_um=drift_um,
        verdicts=DRIFTS,
        effects=HEAT,
    )


def klipper_speeds() -> MachineLog:
    """A copied console of Mainsail, four speeds; sound."""
    rng = np.random.default_rng(32)
    now_s, lines = 65_100.0, ["$ G28", "$ STATUS", "// Klipper state: Ready"]
    text = "".join(f"{_clock(now_s)[:8]}  {line}\n" for line in lines)
    for speed in (2, 5, 10, 20):
        zs = np.empty(10)
        text += f"{_clock(now_s)[:8]}  $ PROBE_ACCURACY PROBE_SPEED={speed}\n"
        text += f"{_clock(now_s)[:8]}  // PROBE_ACCURACY at X:60.000 Y:110.000 Z:5.000 "
        text += f"(samples=10 retract=2.000 speed={speed:.1f} lift_speed=5.0)\n"
        for number in range(10):
            now_s += 2.0 + 5.0 / speed
            zs[number] = _stepped(2.512 + rng.normal(0.0, 0.0018), 0.00125)
            text += f"{_clock(now_s)[:8]}  // probe at 60.000,110.000 is z={zs[number]:f}\n"
        text += f"{_clock(now_s)[:8]}  // {_klipper_series(zs)}\n"
    text += f'{_clock(now_s)[:8]}  !! Unknown command:"FOO"\n'
    return MachineLog("klipper", {"mainsail.txt": text}, touches=40)


def marlin_m48() -> MachineLog:
    """Pronterface: M503, then M48 twice; sound."""
    rng = np.random.default_rng(41)
    text = (
        "Connecting...\nstart\nPrinter is now online.\necho: External Reset\nMarlin 2.1.2.1\n"
        ">>> M503\nSENDING:M503\necho:; Steps per unit:\necho:  M92 X80.00 Y80.00 Z400.00 E93.00\n"
        "echo:  M201 X500.00 Y500.00 Z100.00 E5000.00\necho:  M851 X-44.00 Y-6.00 Z-2.31\nok\n"
    )
    for count in (10, 20):
        text += f">>> M48 P{count} X117 Y117 V4\nSENDING:M48 P{count} X117 Y117 V4\n"
        text += "M48 Z-Probe Repeatability Test\nPositioning the probe...\n"
        zs = [_stepped(-0.012 + rng.normal(0.0, 0.0022), 0.0025) for _ in range(count)]
        for number in range(1, count + 1):
            z = np.array(zs[:number])
            text += f"{number} of {count}: z: {z[-1]:.3f} mean: {z.mean():.4f} "
            text += f"sigma: {z.std():f} min: {z.min():.3f} max: {z.max():.3f}\n"
            text += "echo:busy: processing\n" * (number % 6 == 0)
        text += f"Finished!\nMean: {np.mean(zs):f} Min: {min(zs):.3f} Max: {max(zs):.3f}\n"
        text += f"Standard Deviation: {np.std(zs):f}\n\nok P15 B3\n"
    return MachineLog("marlin", {"m48.txt": text}, touches=30, options=("--feed", "300"))


def marlin_heating() -> MachineLog:
    """OctoPrint: G30 while the bed goes from 21 to 60 °C, and Z with it by 2.2 µm/K."""
    rng = np.random.default_rng(42)
    now_s, bed_c = 25_200.0, 21.0
    text = ""

    def say(*lines: str) -> None:
        nonlocal text
        stamp = _clock(now_s).replace(".", ",")
        text += "".join(f"2024-02-17 {stamp} - {line}\n" for line in lines)

    say('Changing monitoring state from "Opening serial connection" to "Connecting"')
    say("Send: N0 M110 N0*125", "Recv: ok", "Recv: FIRMWARE_NAME:Marlin 2.0.9.7 (Jun  4 2023)")
    for number in range(30):
        bed_c = 21.0 - 39.0 * np.expm1(-number / 9.0)
        z = 0.05 + 0.0022 * (bed_c - 21.0) + rng.normal(0.0, 0.003)
        say(f"Send: N{number + 2} G30 X100 Y100*{40 + number}")
        now_s += 5.8
        say("Recv: echo:busy: processing", f"Recv: Bed X: 100.000 Y: 100.000 Z: {z:.3f}")
        say("Recv: ok", "Send: M105", f"Recv: ok T:21.30 /0.00 B:{bed_c:.2f} /60.00 @:0 B@:127")
        now_s += 24.0
    return MachineLog(
        "marlin",
        {"serial.log": text},
        touches=30,
        options=("--feed", "300"),
        drift_um=-2.2 * (bed_c - 21.0),
        verdicts=DRIFTS,
        effects=HEAT,
    )


def saleae_latency() -> MachineLog:
    """Logic 2: a latch 6.2 µs and up to 1.3 µs more after the probe, beside a busy serial line."""
    rng = np.random.default_rng(51)
    changes: list[tuple[float, int, int]] = []
    now_s = 0.1
    for _ in range(200):
        now_s += 0.02 + rng.uniform(0.0, 0.01)
        latched_s = now_s + 6.2e-6 + rng.uniform(0.0, 1.3e-6)
        changes += [(now_s, 0, 1), (latched_s, 1, 1), (latched_s + 5e-5, 1, 0)]
        changes += [(now_s + 4e-3, 0, 0)]
    uart_s = np.sort(rng.uniform(0.0, now_s, 300))
    changes += [(float(at), 2, number % 2) for number, at in enumerate(uart_s, 1)]
    levels, text = [0, 0, 0], "Time [s],Probe,IRQ latch,UART TX\n0.000000000,0,0,0\n"
    for at, channel, level in sorted(changes):
        levels[channel] = level
        text += f"{at:.9f},{','.join(map(str, levels))}\n"
    return MachineLog(
        "edges",
        {"digital.csv": text},
        touches=200,
        options=("--probe", "Probe", "--latch", "IRQ latch"),
        verdicts=("explained", "undecided"),
        effects=("isr_latency", "input_filter"),
    )


def sigrok_polled() -> MachineLog:
    """sigrok-cli at 1 MHz: the latch waits for a task that runs every 4 ms."""
    rng = np.random.default_rng(52)
    text = (
        "$date Sat Mar  9 15:11:02 2024 $end\n$version libsigrok 0.5.2 $end\n"
        "$comment\n  Acquisition with 2/8 channels at 1 MHz\n$end\n$timescale 1 us $end\n"
        '$scope module libsigrok $end\n$var wire 1 ! D0 $end\n$var wire 1 " D1 $end\n'
        '$upscope $end\n$enddefinitions $end\n#0 0! 0"\n'
    )
    now_s = 0.05
    for _ in range(120):
        now_s += 0.05 + rng.uniform(0.0, 0.02)
        latched_s = 0.0013 + 0.004 * np.ceil((now_s - 0.0013) / 0.004) + rng.uniform(0.0, 2e-5)
        for at, change in ((now_s, "1!"), (latched_s, '1"'), (now_s + 0.02, "0!")):
            text += f"#{round(at * 1e6)} {change}\n"
        text += f'#{round((latched_s + 0.02) * 1e6)} 0"\n'
    return MachineLog(
        "edges",
        {"capture.vcd": text},
        touches=120,
        options=("--probe", "D0", "--latch", "D1"),
        verdicts=("explained", "partly_explained", "unknown", "undecided"),
        effects=("isr_latency", "input_filter", "timer_quantisation", "link_slotting"),
    )


LOGS: tuple[Callable[[], MachineLog], ...] = (
    linuxcnc_debounced,
    linuxcnc_inches,
    fluidnc_warming,
    grbl_alarms,
    klippy_heating,
    klipper_speeds,
    marlin_m48,
    marlin_heating,
    saleae_latency,
    sigrok_polled,
)
