"""``skiplatch fleet query``: SQL on a store."""

from pathlib import Path

import click

from skiplatch.commands.fleet_options import answer_text, plain, store_option
from skiplatch.commands.options import json_option, write_json
from skiplatch.fleet.reading import opened

EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet query "SELECT rig, count(*) FROM touches GROUP BY rig" --store build/store
"""


@click.command(epilog=EPILOG)
@click.argument("sql")
@store_option
@json_option
def command(sql: str, store: Path, json_path: Path | None) -> None:
    """Answer one SELECT on the tables campaigns, touches, gaps and effects.

    The dialect is DuckDB's. Nothing but the store can be read, and nothing written.
    """
    with opened(store, with_touches=False) as reader:
        answer = reader.query(sql)
    click.echo(answer_text(answer.columns, answer.rows))
    rows = plain(answer.rows)
    write_json(json_path, {"columns": answer.columns, "rows": rows})
