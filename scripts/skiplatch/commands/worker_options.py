"""Options of commands that spread work: processes here, or a cluster."""

import re
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import click

from skiplatch.commands.numbers import TIME_S
from skiplatch.commands.options import Decorator
from skiplatch.errors import quoted
from skiplatch.workers import LIMIT_S, Workers, opened

LOCAL = "local:"
LOCAL_WORKERS = re.compile(r"[0-9]{1,4}")
MOST_LOCAL = 1024
ADDRESS = re.compile(r"(?:[a-z]+://)?[^\s/:]+:[0-9]{1,5}")


class ClusterType(click.ParamType[str]):
    """Where a cluster is: ``local:N``, or where its scheduler listens."""

    name = "address"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:  # noqa: ANN401
        """See `click.ParamType.convert`."""
        text = str(value)
        number = text.removeprefix(LOCAL)
        if text.startswith(LOCAL):
            is_good = LOCAL_WORKERS.fullmatch(number) is not None and 1 <= int(number) <= MOST_LOCAL
        else:
            is_good = ADDRESS.fullmatch(text) is not None
        if not is_good:
            expected = f"expected local:N with 1 to {MOST_LOCAL} workers, or HOST:PORT"
            self.fail(f"{expected}, got {quoted(text)}", param, ctx)
        return text


cluster_option: Decorator = click.option(
    "--cluster",
    type=ClusterType(),
    metavar="ADDRESS",
    help="Spread the work over a Dask cluster instead: where its scheduler listens, such as "
    "tcp://head:8786; or local:N, which starts N workers here. The result is the same.",
)

limit_option: Decorator = click.option(
    "--task-limit-s",
    "limit_s",
    type=TIME_S,
    metavar="SECONDS",
    default=LIMIT_S,
    show_default=True,
    help="A piece of spread work that takes longer is ended, tried again, and in the end told by "
    "name; the rest is not lost.",
)


def cluster_if_named(
    cluster: str | None, limit_s: float
) -> AbstractContextManager[Executor | None]:
    """Open the cluster; None where none is named, and the work is done here."""
    if cluster is None:
        return nullcontext()
    return opened(Workers(cluster=cluster, limit_s=limit_s))
