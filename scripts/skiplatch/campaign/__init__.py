"""Campaigns: what a bench or a machine recorded, format ``skiplatch-campaign/2`` and its subset 1.

A campaign is a folder with ``nominal.toml`` (what the engineer believes of the rig) and
``touches.csv`` (one row a touch).
"""

from skiplatch.campaign.believed_effect import BelievedEffect
from skiplatch.campaign.column_kinds import NOT_RECORDED
from skiplatch.campaign.columns import (
    COLUMNS,
    CONDITIONS,
    LINEAR_AXES,
    Axis,
    InputPath,
    Status,
)
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.campaign.folder import (
    NOMINAL_FILE,
    TOUCHES_FILE,
    Campaign,
    read_campaign,
    refuse_no_campaign,
    write_campaign,
)
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.nominal import (
    FORMATS,
    KEYS,
    SECTIONS,
    AxisNominal,
    BenchNominal,
    InputNominal,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
)
from skiplatch.campaign.nominal_text import format_effect, format_nominal, write_nominal
from skiplatch.campaign.nominal_toml import read_nominal
from skiplatch.campaign.reading import read_conditions, read_touches
from skiplatch.campaign.touches import Touches
from skiplatch.campaign.writing import fingerprint, format_touches, write_touches

__all__ = [
    "COLUMNS",
    "CONDITIONS",
    "FORMATS",
    "KEYS",
    "LINEAR_AXES",
    "NOMINAL_FILE",
    "NOT_RECORDED",
    "SECTIONS",
    "TOUCHES_FILE",
    "Axis",
    "AxisNominal",
    "BelievedEffect",
    "BenchNominal",
    "Campaign",
    "Datum",
    "DatumFreedom",
    "InputNominal",
    "InputPath",
    "Kind",
    "Nominal",
    "PlcNominal",
    "ProbeNominal",
    "ReportNominal",
    "SkipNominal",
    "Status",
    "Touches",
    "fingerprint",
    "format_effect",
    "format_nominal",
    "format_touches",
    "read_campaign",
    "read_conditions",
    "read_nominal",
    "read_touches",
    "refuse_no_campaign",
    "write_campaign",
    "write_nominal",
    "write_touches",
]
