"""``skiplatch bench``: play a plan on a Linux bench, watch it, or say what to believe of it."""

import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import click

from skiplatch.bench.belief import Belief
from skiplatch.bench.belief import believe as believe_campaign
from skiplatch.bench.bus import open_bus
from skiplatch.bench.monitor import Monitor
from skiplatch.bench.plan import Plan, read_plan
from skiplatch.bench.recording import as_touches
from skiplatch.bench.run import Player, Recording, Rig, summary
from skiplatch.bench.seal import read_key
from skiplatch.bench.station import Station
from skiplatch.campaign import format_nominal, read_campaign, write_campaign
from skiplatch.campaign.folder import TOUCHES_FILE
from skiplatch.commands.bench_options import (
    bench_rig_options,
    can_backend_option,
    key_option,
    latch_id_option,
)
from skiplatch.commands.inputs import FILE, Source
from skiplatch.commands.numbers import CountType, NumberType
from skiplatch.commands.options import json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFile, OutputFolder
from skiplatch.errors import InputError, one_line
from skiplatch.files import atomic_write_text
from skiplatch.stand_ins import refuse_unplayable
from skiplatch.statistics import Interval
from skiplatch.undo import INTERRUPTED, keep_outputs

RUN_EPILOG = """\b
Example, with a real line (output 17 wired to input 4):
  skiplatch bench run scripts/samples/plans/nominal.toml --out build/bench \\
      --can can0 --chip gpiochip0 --line 4 --inject-line gpiochip0:17
With a simulated one:
  skiplatch bench run scripts/samples/plans/nominal.toml --out build/bench --can vcan0 \\
      --chip gpiochip0 --line 0 \\
      --sim-pull /sys/devices/platform/gpio-sim.0/gpiochip0/sim_gpio0/pull
"""
MONITOR_EPILOG = """\b
Example:
  skiplatch bench monitor vcan0 --seconds 60
"""
BELIEVE_EPILOG = """\b
Example: believe from one quiet campaign, diagnose another one
  skiplatch bench believe build/quiet --out build/believed.toml
  skiplatch bench run scripts/samples/plans/cpu_load.toml --nominal build/believed.toml \\
      --out build/cpu_load --can can0 --chip gpiochip0 --line 4 --inject-line gpiochip0:17
  skiplatch diagnose build/cpu_load
"""


@click.group()
def command() -> None:
    """Inject edges over CAN and record how they are latched: a Linux bench.

    Example: skiplatch bench monitor vcan0
    """


def _interrupt(*_: object) -> NoReturn:
    raise KeyboardInterrupt


@command.command(epilog=RUN_EPILOG)
@click.argument("plan_path", metavar="PLAN.toml", type=FILE)
@click.option(
    "-o",
    "--out",
    type=OutputFolder(is_new=True),
    required=True,
    help="Folder of the campaign; must not hold anything yet. One in it for each of several scans.",
)
@click.option("--nominal", "nominal_path", type=FILE, help="Instead of the plan's nominal.toml.")
@bench_rig_options
@can_backend_option
@seed_option
@json_option
@click.pass_context
def run(
    ctx: click.Context,
    plan_path: Path,
    out: Path,
    nominal_path: Path | None,
    rig: Rig,
    can_backend: str,
    seed: int,
    json_path: Path | None,
) -> None:
    """Play a plan on the bench and write what was latched as a campaign.

    Starts controller, injector and loads, and ends them. Ctrl-C ends early; what was played until
    then is written.
    """
    plan = read_plan(plan_path, nominal_path)
    key = read_key(rig.key_path) if rig.key_path else None
    failure: InputError | None = None
    is_interrupted = False
    before = signal.signal(signal.SIGTERM, _interrupt)
    try:
        with open_bus(rig.interface, can_backend, rig.latch_id) as bus:
            station = Station(bus, rig.interface, rig.latch_id, key)
            player = Player(plan, rig, station, seed)
            try:
                player.play()
            except KeyboardInterrupt:
                is_interrupted = True
            except InputError as error:
                failure = error
    finally:
        signal.signal(signal.SIGTERM, before)
    written = _write(plan, player.recordings, out)
    write_json(json_path, _as_json(written, seed, is_complete=not is_interrupted and not failure))
    if failure is not None:
        keep_outputs()  # what was played until then
        raise failure
    if is_interrupted:
        click.echo("interrupted", err=True)
        ctx.exit(INTERRUPTED)


def _write(plan: Plan, recordings: Sequence[Recording], out: Path) -> dict[Path, Recording]:
    """Write a campaign for each scan period that anything was recorded with."""
    written: dict[Path, Recording] = {}
    for recording in recordings:
        if not recording.played:
            continue
        folder = out if len(plan.scan_us) == 1 else out / f"scan_{recording.scan_us}_us"
        believed = plan.believed(recording.scan_us)
        write_campaign(
            folder, believed, as_touches(plan, believed, recording.axis, recording.played)
        )
        found = summary(recording)
        click.echo(
            f"{folder}: {found['touches']} touches, {found['missed']} missed, {found['false']} "
            f"false; edges known to {found['edge_window_us']:.1f} µs"
        )
        if recording.lost_latches or recording.restarts:
            click.echo(
                f"{folder}: {recording.lost_latches} latch records lost on the bus, "
                f"{recording.restarts} restarts of the controller",
                err=True,
            )
        written[folder] = recording
    return written


def _as_json(written: dict[Path, Recording], seed: int, *, is_complete: bool) -> dict[str, Any]:
    return {
        "format": "skiplatch-bench/1",
        "seed": seed,
        "complete": is_complete,
        "campaigns": [
            {"campaign": str(folder), **summary(recording), "counters": recording.counters}
            for folder, recording in written.items()
        ],
    }


@command.command(epilog=MONITOR_EPILOG)
@click.argument("interface", metavar="IFACE")
@click.option("--seconds", type=NumberType(0.01, 1e9), help="End after so long.")
@click.option("--latches", type=CountType(1, 10**9), help="End after so many latches.")
@click.option(
    "--quiet-injector", is_flag=True, help="Send nothing: leave out the injector's counters."
)
@latch_id_option
@key_option
@can_backend_option
@json_option
def monitor(
    *,
    interface: str,
    seconds: float | None,
    latches: int | None,
    quiet_injector: bool,
    latch_id: int,
    key_path: Path | None,
    can_backend: str,
    json_path: Path | None,
) -> None:
    """Show latches as they come, and the counters at the end; Ctrl-C ends.

    Edge to latch is shown where an injector reports its edges.
    """
    key = read_key(key_path) if key_path else None
    with open_bus(interface, can_backend, latch_id) as bus:
        station = Station(bus, interface, latch_id, key)
        watching = Monitor(station, click.echo)
        try:
            watching.watch(seconds, latches)
        except KeyboardInterrupt:
            click.echo(err=True)
        counters = watching.counters({} if quiet_injector else station.counts())
    for name, value in counters.items():
        if name != "injector":
            click.echo(f"{name.replace('_', ' '):24} {value}")
    for name, value in counters["injector"].items():
        click.echo(f"injector {name:15} {value}")
    write_json(json_path, {"format": "skiplatch-bench-monitor/1", **counters})


@command.command(epilog=BELIEVE_EPILOG)
@click.argument("campaign_path", metavar="CAMPAIGN", type=Source())
@click.option(
    "-o", "--out", type=OutputFile(), required=True, help="nominal.toml to write; an old one goes."
)
@seed_option
@json_option
def believe(campaign_path: Path, out: Path, seed: int, json_path: Path | None) -> None:
    """Write what a quiet CAMPAIGN of the bench shows as the nominal of further ones.

    Skip latency and jitter, report latency and jitter, and the noise of the reference are those
    that reproduce the 5 % to 95 % quantiles of the touches; all else stays as the campaign's own
    nominal has it. The seed is of the intervals.
    """
    campaign = read_campaign(campaign_path)
    belief = believe_campaign(campaign, seed)
    believed = belief.in_place_of(campaign.nominal)
    refuse_unplayable(campaign_path / TOUCHES_FILE, believed)
    head = (
        f"# Of the bench itself: from {belief.skip_touches} touches on the skip path and "
        f"{belief.reports} reports\n# of {one_line(campaign_path.name)}, 5 % to 95 % quantiles.\n"
    )
    atomic_write_text(out, head + format_nominal(believed))
    for name, interval in _figures(belief):
        click.echo(
            f"{name:24} {interval.value:8.1f} µs   {interval.low:.1f} … {interval.high:.1f} µs"
        )
    write_json(json_path, belief.as_json())


def _figures(belief: Belief) -> list[tuple[str, Interval]]:
    return [
        ("skip.latency_us", belief.skip_latency_us),
        ("skip.jitter_us", belief.skip_jitter_us),
        ("report.latency_us", belief.report_latency_us),
        ("report.jitter_us", belief.report_jitter_us),
        ("bench.reference_jitter_us", belief.reference_jitter_us),
    ]
