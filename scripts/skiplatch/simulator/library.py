"""The one place where Python reaches C: the shared library of the simulation, and its structures.

The library is built by ``make setup``, or comes with the wheel. Its structures are read from the C
headers themselves, so that their fields stand in one place.
"""

import os
import re
from functools import cache
from pathlib import Path
from typing import Any

import cffi
import numpy as np

from skiplatch.places import ROOT

LIBRARY = ROOT / "build" / "host" / "libskiplatch_sim.so"
HEADERS = (
    ROOT / "firmware" / "comp" / "pulse_judge.h",
    ROOT / "firmware" / "comp" / "phase_meter.h",
    ROOT / "firmware" / "comp" / "transmission.h",
    ROOT / "host_sim" / "chain.h",
    ROOT / "host_sim" / "effects" / "description.h",
    ROOT / "host_sim" / "gear_train.h",
    ROOT / "scripts" / "skiplatch" / "diagnosis" / "density" / "law.h",
    ROOT / "scripts" / "skiplatch" / "diagnosis" / "likelihood" / "physics.h",
    ROOT / "scripts" / "skiplatch" / "diagnosis" / "likelihood" / "stream_law.h",
    ROOT / "scripts" / "skiplatch" / "diagnosis" / "likelihood" / "lines.h",
    ROOT / "scripts" / "skiplatch" / "diagnosis" / "likelihood" / "streams.h",
    ROOT / "host_sim" / "api" / "batch.h",
    ROOT / "firmware" / "cycle" / "overtravel.h",
    ROOT / "firmware" / "comp" / "pretravel.h",
    ROOT / "firmware" / "comp" / "pretravel_fit.h",
    ROOT / "firmware" / "comp" / "pretravel_map.h",
    ROOT / "firmware" / "comp" / "pretravel_lookup.h",
    ROOT / "firmware" / "comp" / "pretravel_grid.h",
    ROOT / "firmware" / "comp" / "kinematics.h",
    ROOT / "firmware" / "comp" / "kinematics_circle.h",
    ROOT / "host_sim" / "api" / "kinematics_fit.h",
    ROOT / "host_sim" / "five_axis.h",
    ROOT / "host_sim" / "api" / "five_axis_points.h",
    ROOT / "host_sim" / "api" / "sim_station.h",
    ROOT / "host_sim" / "api" / "five_axis_cycle.h",
    ROOT / "host_sim" / "api" / "kinematics_results.h",
    ROOT / "host_sim" / "api" / "kinematics_memory.h",
    ROOT / "host_sim" / "api" / "trains.h",
)

CData = Any
"""What cffi hands out has no static type."""


class SimulationError(Exception):
    """The simulation refused what it was given, or is not built."""


def declarations(header: Path) -> str:
    """Give what cffi understands of a header: no comments, nothing of the preprocessor."""
    text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.DOTALL)
    text = re.sub(r"#ifdef __cplusplus\n.*?#endif\n", "", text, flags=re.DOTALL)
    return "\n".join(line for line in text.splitlines() if not line.startswith("#"))


@cache
def connection() -> tuple[CData, CData]:
    """Give cffi's interface and the library.

    Raises:
        SimulationError: The library is not built.
    """
    if not LIBRARY.exists():
        raise SimulationError(f"{LIBRARY}: not built; run 'make setup'")
    ffi: CData = cffi.FFI()
    for header in HEADERS:
        ffi.cdef(declarations(header))
    return ffi, ffi.dlopen(os.fspath(LIBRARY))


def _element(member: CData) -> tuple[str, tuple[int, ...]]:
    """Give numpy's code of what a member of a structure holds, and the shape of an array of it."""
    codes = {
        "double": "f8",
        "int32_t": "i4",
        "int64_t": "i8",
        "uint32_t": "u4",
        "uint64_t": "u8",
    }
    if member.kind == "array":
        return codes[member.item.cname], (member.length,)
    return codes[member.cname], ()


@cache
def layout(name: str) -> np.dtype[np.void]:
    """Give the numpy type of an array of structures, aligned as the compiler does it.

    Raises:
        SimulationError: The library is not built, or numpy lays such a structure out differently.
    """
    ffi, _ = connection()
    members = [(member, *_element(f.type)) for member, f in ffi.typeof(name).fields]
    found = np.dtype(members, align=True)
    if found.itemsize != ffi.sizeof(name):
        raise SimulationError(f"{name}: numpy lays it out differently from the C compiler")
    return found
