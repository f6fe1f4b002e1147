"""What rigs of a kind have, with the source of each figure."""

from collections.abc import Mapping
from dataclasses import dataclass

from skiplatch.campaign import Kind
from skiplatch.importing.model import Figure, Figures

_PROBE = ("probe", "repeatability_um")
_PRINTER_PROBE = Figure(
    4.0, "Klipper's Probe_Calibrate.md takes ten touches within 25 µm, so 1 sigma below 8 µm", 4.0
)
_PLATE = Figure(3.0, "touch plates and tool setters scatter by micrometres; the touches tell", 3.0)
_GRBL_PIN = "grbl stepper.c reads the probe pin in every turn of the stepper interrupt"


@dataclass(frozen=True, slots=True)
class Preset:
    """A kind of rig.

    Attributes:
        kind: Bench or machine.
        about: One line.
        figures: Numbers of nominal.toml, each with its source.
    """

    kind: Kind
    about: str
    figures: Figures


PRESETS: Mapping[str, Preset] = {
    "linuxcnc-1ms": Preset(
        Kind.MACHINE,
        "LinuxCNC: motion.probe-input is read once a servo period, path plc",
        {
            ("plc", "scan_us"): Figure(
                1000.0, "SERVO_PERIOD = 1000000 ns of the sample configurations, [EMCMOT]"
            ),
            _PROBE: _PLATE,
        },
    ),
    "grbl-avr": Preset(
        Kind.MACHINE,
        "grbl 1.1 on an ATmega328P",
        {
            ("skip", "latency_us"): Figure(0.0, _GRBL_PIN),
            ("skip", "jitter_us"): Figure(
                33.0, "one turn of the stepper interrupt at its highest rate, 30 kHz", 10.0
            ),
            ("axis", "resolution_um"): Figure(4.0, "$100 = 250 steps/mm, config default"),
            ("axis", "accel_mm_s2"): Figure(10.0, "$120 = 10 mm/s², config default"),
            _PROBE: _PLATE,
        },
    ),
    "grblhal": Preset(
        Kind.MACHINE,
        "grblHAL, FluidNC or Grbl_Esp32 on a 32-bit controller",
        {
            ("skip", "latency_us"): Figure(0.0, "stepper.c reads the probe pin before each step"),
            ("axis", "resolution_um"): Figure(4.0, "$100 = 250 steps/mm, config default"),
            ("axis", "accel_mm_s2"): Figure(10.0, "$120 = 10 mm/s², config default"),
            _PROBE: _PLATE,
        },
    ),
    "klipper": Preset(
        Kind.MACHINE,
        "Klipper: the micro-controller samples the probe, the host works out the position",
        {
            ("skip", "latency_us"): Figure(0.0, "the first sample that shows it counts"),
            ("skip", "jitter_us"): Figure(
                60.0, "klippy/mcu.py: 4 samples, 15 µs apart (ENDSTOP_SAMPLE_TIME, _COUNT)", 20.0
            ),
            _PROBE: _PRINTER_PROBE,
        },
    ),
    "marlin": Preset(
        Kind.MACHINE,
        "Marlin: endstops are read in the stepper or the temperature interrupt",
        {
            ("axis", "resolution_um"): Figure(
                2.5, "DEFAULT_AXIS_STEPS_PER_UNIT of Z = 400 steps/mm, Configuration.h"
            ),
            ("skip", "jitter_us"): Figure(
                1000.0, "endstops are read at least once a turn of the temperature interrupt, 1 kHz"
            ),
            _PROBE: _PRINTER_PROBE,
        },
    ),
    "plc-4ms": Preset(
        Kind.MACHINE,
        "a PLC task that polls every 4 ms",
        {
            ("plc", "scan_us"): Figure(4000.0, "the cycle time that the task is set to"),
            _PROBE: _PLATE,
        },
    ),
    "bench": Preset(
        Kind.BENCH,
        "edges injected at the connector, seen by a logic analyser",
        {
            ("bench", "reference_jitter_us"): Figure(
                0.012, "a sample at 24 MS/s is 0.0417 µs wide: that over √12", 0.006
            ),
        },
    ),
}
