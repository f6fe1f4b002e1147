"""How fast a fleet is kept and shown.

A million touches are added, a rig's history is asked of ten million, and all rigs become a page.
"""

import os
import subprocess
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import duckdb
from diagnosis_bench import NOMINAL, SKIPLATCH, conditions, played

from skiplatch.campaign import read_nominal, write_campaign
from skiplatch.fleet import layout
from skiplatch.fleet.contents import digest_of
from skiplatch.fleet.reading import opened as opened_store
from skiplatch.fleet.store import opened_for_writing
from skiplatch.fleet.wholeness import index_digest
from skiplatch.simulator.effects import Effect

RIGS, WEEKS, TOUCHES = 200, 52, 1_000
HISTORY_AIM_S, PAGE_AIM_S = 1.0, 2.0
ADDED, ADDED_AIM_S = 1_000, 60.0
"""Campaigns that are added: the first and the last tenth by a command of their own."""
EFFECT = Effect("trigger_delay", {"delay_us": 60.0})
INDEX = """
CREATE TABLE campaigns AS SELECT * EXCLUDE (rig_number, week) REPLACE (
    'rig-' || lpad(rig_number::VARCHAR, 3, '0') AS rig,
    md5(rig_number || '-' || week) || md5(week || '-' || rig_number) AS campaign,
    recorded_at + week * INTERVAL 7 DAY AS recorded_at,
    strftime(recorded_at + week * INTERVAL 7 DAY, '%Y-%m') AS month,
    'no_gap' AS verdict,
    hash(rig_number, week) % 1000 / 1e3 AS gap_um,
    [
        {
            'observable': one[1],
            'unit': one[2],
            'before': hash(rig_number, week, one[1]) % 1000 / 1e3,
            'after': 5e-1,
            'noise_floor': 5e-1,
        }
        FOR one IN [['deviation', 'µm'], ['latch error', 'µs']]
    ] AS gaps
)
FROM read_parquet($index), range($rigs) rigs(rig_number), range($weeks) weeks(week)
"""
ROWS = "SELECT rig, month, campaign, content FROM campaigns ORDER BY rig, recorded_at"
TOUCHES_DIGEST = "UPDATE campaigns SET touches_sha256 = ? WHERE campaign = ?"
INDEX_DIGEST = "UPDATE campaigns SET index_sha256 = ?"
WRITTEN = """
COPY (FROM campaigns ORDER BY rig, recorded_at) TO '{target}' (FORMAT parquet, COMPRESSION zstd)
"""
OF_CAMPAIGN = """
COPY (SELECT * REPLACE ($campaign AS campaign) FROM read_parquet($file, hive_partitioning = false))
TO '{target}' (FORMAT parquet, COMPRESSION zstd)
"""


def fill(folder: Path, rigs: int, weeks: int, touches: int) -> Path:
    """Make a store with a campaign of so many touches for each rig and week.

    One campaign is added; the files of the others are made of its own, and each has a gap of its
    own, which chance has made. Those of all rigs but the
    first are its very bytes, which is cheaper and which a look at the first never reads.
    """
    campaign, store = folder / "campaign", folder / "store"
    record(campaign, touches, seed=1)
    with opened_for_writing(store) as writer:
        writer.add(campaign, "seed")
        writer.commit()
    (first,) = store.glob("touches/*/*/*.parquet")
    (packed,) = store.glob("folders/*/*/*.zip")
    index = store / layout.INDEX_FILE
    with duckdb.connect(":memory:") as engine:
        whole = {"index": str(index), "rigs": rigs, "weeks": weeks}
        engine.execute(INDEX, whole)
        rows = engine.execute(ROWS).fetchall()
        for rig, month, key, content in rows:
            touches_file = room(store, layout.TOUCHES, rig, month, key)
            if rig == rows[0][0]:
                of_campaign = {"campaign": key, "file": str(first)}
                engine.execute(OF_CAMPAIGN.format(target=touches_file), of_campaign)
                engine.execute(TOUCHES_DIGEST, [digest_of(touches_file).hex(), key])
            else:
                touches_file.hardlink_to(first)
            folder_file = room(store, layout.FOLDERS, rig, month, content)
            if not folder_file.exists():
                folder_file.hardlink_to(packed)
        engine.execute(INDEX_DIGEST, [index_digest(engine)])
        engine.execute(WRITTEN.format(target=index))
    return store


def room(store: Path, table: str, rig: str, month: str, name: str) -> Path:
    """Give the place of a file, whose folder is there then."""
    target = layout.place(store, table, rig, month, name)
    target.parent.mkdir(parents=True, exist_ok=True)
    return target


def record(campaign: Path, touches: int, seed: int) -> None:
    """Write a campaign with an effect."""
    nominal = read_nominal(NOMINAL)
    write_campaign(campaign, nominal, played(nominal, conditions(touches), EFFECT, seed))


def bench_history(folder: Path) -> None:
    """Time what a rig was, out of ten million touches."""
    store = fill(folder, RIGS, WEEKS, TOUCHES)
    begin = time.perf_counter()
    with opened_store(store, with_touches=False) as reader:
        weeks = reader.history("rig-000").rows
    seconds = time.perf_counter() - begin
    whole = timed([str(SKIPLATCH), "fleet", "show", "rig-000", "--store", str(store)])
    page = folder / "page.html"
    paged = timed([str(SKIPLATCH), "fleet", "report", "--store", str(store), "--html", str(page)])
    everything = RIGS * WEEKS * TOUCHES
    print(f"a rig's history of {len(weeks)} campaigns in a store of {everything:,} touches")
    print(f"  {seconds:9.2f} s, the whole command {whole:.2f} s   aim: at most {HISTORY_AIM_S:g} s")
    print(f"  the page of all {RIGS} rigs, {page.stat().st_size / 1e6:.1f} MB")
    print(f"  {paged:9.2f} s   aim: at most {PAGE_AIM_S:g} s")


def bench_adding(folder: Path) -> None:
    """Time a million touches on their way into a store, and what memory the first and last take."""
    campaigns = [folder / f"added_{number}" for number in range(ADDED)]
    for seed, campaign in enumerate(campaigns):
        record(campaign, TOUCHES, seed)
    tenth = ADDED // 10
    parts = campaigns[:tenth], campaigns[tenth:-tenth], campaigns[-tenth:]
    took = [add(part, folder / "added") for part in parts]
    (_, first_mb), _, (_, last_mb) = took
    print(f"{ADDED * TOUCHES:,} touches added to a store")
    print(f"  {sum(s for s, _ in took):9.1f} s   aim: at most {ADDED_AIM_S:g} s")
    print(f"  memory, last tenth over first {last_mb / first_mb:.2f} ({last_mb:.0f} MB)   aim: 1")


def add(campaigns: Sequence[Path], store: Path) -> tuple[float, float]:
    """Add campaigns by a command; gives its seconds, and its largest memory in MB."""
    words: list[str | Path] = [
        SKIPLATCH,
        "fleet",
        "add",
        *campaigns,
        "--rig",
        "bench",
        "--store",
        store,
    ]
    begin = time.perf_counter()
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit("fleet_bench: fleet add failed")
    return time.perf_counter() - begin, used.ru_maxrss / 1e3


def timed(words: Sequence[str]) -> float:
    """Time a command."""
    begin = time.perf_counter()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def bench_fleet() -> None:
    """Run it in a folder that goes afterwards."""
    with tempfile.TemporaryDirectory() as temporary:
        bench_adding(Path(temporary))
        bench_history(Path(temporary))


if __name__ == "__main__":
    bench_fleet()
