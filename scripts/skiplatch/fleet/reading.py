"""Reading a store: its tables for SQL, a fleet in figures, a rig's history, a campaign's folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from skiplatch.errors import InputError, quoted
from skiplatch.fleet import layout
from skiplatch.fleet.contents import unpack
from skiplatch.fleet.engine import Connection, connect, failures_told, literal
from skiplatch.fleet.named import named
from skiplatch.fleet.origin import tidied
from skiplatch.fleet.tables import kept_touches
from skiplatch.fleet.wholeness import load_index, whole_touches

CAMPAIGN_VIEWS = """
CREATE VIEW gaps AS SELECT campaign, rig, recorded_at, unnest(gaps, recursive := true)
    FROM campaigns;
CREATE VIEW effects AS SELECT campaign, rig, recorded_at, unnest(effects, recursive := true)
    FROM campaigns;
"""
TOUCHES_VIEW = """
CREATE VIEW touches AS SELECT kept.*, nominal, tool, seed
    FROM kept JOIN (SELECT campaign, nominal, tool, seed FROM campaigns) USING (campaign);
"""
RIGS = """
SELECT * EXCLUDE (gap), gap.um AS gap_um, gap.arcsec AS gap_arcsec FROM (
    SELECT rig, count(*) AS campaigns, sum(touches)::BIGINT AS touches, min(recorded_at) AS first,
        max(recorded_at) AS last, max_by(verdict, (recorded_at, campaign)) AS verdict,
        max_by({'um': gap_um, 'arcsec': gap_arcsec}, (recorded_at, campaign))
            FILTER (coalesce(gap_um, gap_arcsec) IS NOT NULL) AS gap
    FROM campaigns GROUP BY rig
) ORDER BY rig
"""
HISTORY = f"""
SELECT campaign, recorded_at, folder, campaigns.touches AS touches, deviation_um, deviation_sd_um,
    deviation_arcsec, deviation_sd_arcsec, verdict, gap_um, gap_arcsec, stage,
    coalesce(axes, 'linear') AS axes, effects
FROM campaigns JOIN (
    SELECT campaign, avg(moved_um) AS deviation_um, stddev(moved_um) AS deviation_sd_um,
        avg(deviation_arcsec) AS deviation_arcsec, stddev(deviation_arcsec) AS deviation_sd_arcsec
    FROM (
        SELECT *, CASE WHEN axis IN ('A', 'B', 'C') THEN NULL ELSE deviation_um END AS moved_um
        FROM ({kept_touches("$files, hive_partitioning = false")})
    ) GROUP BY campaign
) USING (campaign) WHERE rig = $rig ORDER BY recorded_at, campaign
"""  # noqa: S608 - names of the product's own
PLACES = "SELECT rig, month, campaign, touches_sha256, folder FROM campaigns"


@dataclass(frozen=True, slots=True)
class Answer:
    """What a query gives.

    Attributes:
        columns: Their names.
        rows: A value a column.
    """

    columns: list[str]
    rows: list[tuple[Any, ...]]

    def mappings(self) -> list[dict[str, Any]]:
        """Give each row by the names of its columns."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


@dataclass(frozen=True, slots=True)
class Reader:
    """A store as it stood when it was opened; a writer beside it changes nothing here."""

    path: Path
    engine: Connection

    def rigs(self) -> Answer:
        """Give each rig with its campaigns, touches, first and last time and last diagnosis."""
        return self._ask(RIGS)

    def history(self, rig: str) -> Answer:
        """Give the campaigns of a rig in the order of time, with deviation, gap and effects.

        Only the files of this rig are opened, so the time does not grow with the fleet.

        Raises:
            InputError: There is no such rig.
        """
        places = self._places(rig)
        if not places:
            rig = str(tidied(rig))  # as `add` writes it; an older version wrote it as it was
            places = self._places(rig)
        if not places:
            raise InputError(self.path, None, None, f"no rig {quoted(rig)} in this store")
        return self._ask(HISTORY, {"rig": rig, "files": whole_touches(self.path, places)})

    def _places(self, rig: str) -> list[tuple[Any, ...]]:
        return self._ask(f"{PLACES} WHERE rig = $rig", {"rig": rig}).rows

    def query(self, sql: str) -> Answer:
        """Give what one SELECT says.

        Raises:
            InputError: It is none, or it is wrong.
        """
        import duckdb  # noqa: PLC0415 - see `engine.connect`

        with failures_told(Path("SQL")):
            statements = self.engine.extract_statements(sql)
        if len(statements) != 1 or statements[0].type != duckdb.StatementType.SELECT:
            raise InputError("SQL", None, None, "expected one SELECT; a store is only read")
        with failures_told(Path("SQL")):
            try:
                return self._answer(sql)
            except duckdb.CatalogException as error:
                if "with name touches does not exist" not in str(error).lower():
                    raise
        with failures_told(self.path / layout.TOUCHES):
            _view_touches(self.path, self.engine)
        return self._ask(sql, where=Path("SQL"))

    def export(self, name: str, out: Path) -> str:
        """Make the folder of a campaign anew, and give the campaign's key.

        Args:
            name: The beginning of its key, or the name of its folder, if only one has that.
            out: The folder to make.

        Raises:
            InputError: None or several are called that, or the folder cannot be made.
        """
        with failures_told(self.path):
            found = named(self.path, self.engine, name)
        unpack(found.folder, out, found.content)
        return found.key

    def _ask(
        self, sql: str, values: dict[str, Any] | None = None, where: Path | None = None
    ) -> Answer:
        with failures_told(where or self.path):
            return self._answer(sql, values)

    def _answer(self, sql: str, values: dict[str, Any] | None = None) -> Answer:
        asked = self.engine.execute(sql, values)
        return Answer([column[0] for column in asked.description], asked.fetchall())


@contextmanager
def opened(path: Path, *, with_touches: bool = True) -> Iterator[Reader]:
    """Open a store to read: the tables campaigns, touches, gaps and effects.

    Args:
        path: The store.
        with_touches: Whether the table touches is there at once, which is a file for each campaign.
            Else a query that asks for it makes it.

    Raises:
        InputError: It is no store, one of another version, or something foreign is in it.
    """
    path = Path(os.path.realpath(path))
    layout.refuse_foreign(path)
    with connect(path) as engine:
        load_index(path, engine)
        engine.execute(CAMPAIGN_VIEWS)
        _refuse_empty(path, engine)
        if with_touches:
            with failures_told(path / layout.TOUCHES):
                _view_touches(path, engine)
        yield Reader(path, engine)


def _refuse_empty(path: Path, engine: Connection) -> None:
    if engine.execute("SELECT 1 FROM campaigns LIMIT 1").fetchone() is None:
        raise InputError(path, None, None, "an empty store; skiplatch fleet add fills it")


def _view_touches(path: Path, engine: Connection) -> None:
    kept = whole_touches(path, engine.execute(PLACES).fetchall())
    files = ", ".join(map(literal, kept))
    partitioned = "hive_partitioning = true, hive_types = {'rig': VARCHAR, 'month': VARCHAR}"
    engine.execute(f"CREATE VIEW kept AS {kept_touches(f'[{files}], {partitioned}')}")
    engine.execute(TOUCHES_VIEW)
