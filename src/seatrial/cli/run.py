"""``seatrial run``: a trial, or a campaign of trials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..campaigns.sweep import How as SweepHow
from ..cosim.fault_entry import read_fault
from ..cosim.system import Engine
from ..errors import InputError, SimulationError
from ..links.hardware import allow_devices, allow_network
from ..trials.campaign import Campaign, load_campaign, run_campaign
from ..trials.campaign_report import write_campaign_report, write_case_report
from ..trials.cases import Case
from ..trials.hooks import Hooks
from ..trials.report import write_report
from ..trials.run import Result
from ..trials.supervision import run_supervised
from ..trials.trial import Trial, load_trial
from .answer import answer
from .junit import write_junit
from .live import LiveControl, page_of, run_watched
from .looked_at import play
from .named import refuse_rig, runnable
from .options import (
    Autopilot,
    Choices,
    EngineName,
    Faults,
    Out,
    Settings,
    Vehicle,
    changes_of,
    engine_named,
    is_campaign,
)
from .play import Open, Port
from .show import (
    console,
    print_case,
    print_notes,
    print_reachable,
    print_verdicts,
    run_entry,
)
from .statuses import FAILED
from .stopping import stoppable
from .table_run import has_keep, kept_named, run_table
from .watch import Watch


def run(
    trial: Annotated[
        str,
        typer.Argument(
            help="A trial or campaign: a name, a file or a package.", autocompletion=runnable
        ),
    ],
    settings: Settings = None,
    faults: Faults = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    engine: EngineName = "fmu",
    out: Out = None,
    real_time: Annotated[
        float | None,
        typer.Option(metavar="FACTOR", help="In real time: simulated seconds per second of it."),
    ] = None,
    overrun: Annotated[
        str | None,
        typer.Option(metavar="POLICY", help="In real time: 'catch-up', 'slip' or 'abort'."),
    ] = None,
    hardware: Annotated[
        bool, typer.Option("--hardware", help="Allow devices; what is behind them may move.")
    ] = False,
    network: Annotated[
        bool, typer.Option("--network", help="Allow other hosts, and connections from them.")
    ] = False,
    record: Annotated[
        str,
        typer.Option(
            metavar="LEVEL",
            help="What is recorded: 'all' outputs, as the 'trial' says, or what 'criteria' and "
            "plots need.",
        ),
    ] = "trial",
    junit: Annotated[
        Path | None, typer.Option("--junit", metavar="FILE", help="Write a JUnit file, too.")
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1, help="Cases of a campaign side by side (default: every core)."
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option("--resume", help="Go on with a campaign that was stopped, in --out's folder."),
    ] = False,
    live: Annotated[
        bool,
        typer.Option("--live", help="Show the run in three dimensions, in a browser, as it goes."),
    ] = False,
    port: Port = 0,
    open_: Open = False,
    live_control: LiveControl = False,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Run a campaign on the workers of a Dask scheduler, HOST:PORT."
        ),
    ] = None,
    keep: Annotated[
        str | None,
        typer.Option(
            metavar="WHICH",
            help="Leave a table of a campaign, with the run folders of 'all', 'failed' or 'none'.",
        ),
    ] = None,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Write no report: seatrial report makes it.")
    ] = False,
) -> None:
    """Run a trial, or a campaign of trials, and say what holds."""
    chosen = engine_named(engine)
    if hardware:
        allow_devices()
    if network:
        allow_network()
    changes = changes_of(settings, choices, vehicle, autopilot)
    pace = {"factor": real_time, "overrun": overrun}
    pace = {key: value for key, value in pace.items() if value is not None}
    page = page_of(port, open_, hardware, live_control) if live else None
    if page is None and (port or open_ or live_control):
        raise InputError("--port, --open and --live-control go with --live")
    if is_campaign(trial):
        if live:
            raise InputError("--live works with a trial, not with a campaign")
        campaign = load_campaign(trial)
        if settings:
            raise InputError("--set works with a trial; a campaign sets its own parameters")
        if faults:
            raise InputError("--fault works with a trial; a campaign has faults of its own")
        if changes:
            raise InputError("--choose works with a trial; a campaign has choices in its grid")
        if pace:
            raise InputError("--real-time and --overrun work with a trial, not with a campaign")
        if record != "trial":
            raise InputError("--record works with a trial, not with a campaign")
        if resume and out is None:
            raise InputError("--resume needs the campaign's folder, --out FOLDER")
        if keep is not None or cluster is not None or has_keep(campaign):
            sweep = SweepHow(chosen, jobs, cluster, kept_named(keep), resume)
            run_table(campaign, out, sweep, junit=junit, report=not no_report)
            return
        how = How(chosen, jobs, resume)
        _run_campaign(campaign, out, how, Leaves(junit, not no_report))
        return
    if jobs is not None or resume or keep or cluster:
        said = "--jobs, --resume, --keep and --cluster"
        raise InputError(f"{said} work with a campaign; a trial is one run")
    refuse_rig(trial)
    leaves = Leaves(junit, not no_report)
    loaded = load_trial(trial, changes=changes, origin="--set")
    loaded = loaded.failing([read_fault(text, "--fault") for text in faults or []], "--fault")
    loaded = _paced(loaded, pace).recording(record, "--record")
    print_notes(loaded.notes)
    with stoppable() as stop:
        with Watch(loaded.name) as watch:
            hooks = Hooks(
                building=watch.building,
                progress=watch.progress,
                stop_requested=stop.requested,
                interruptible=stop.interruptible,
                reachable=print_reachable,
            )
            if page is None:
                result = run_supervised(loaded, out, engine=chosen, hooks=hooks)
            else:
                result = run_watched(loaded, out, chosen, hooks, page)
        print_verdicts(result)
        answer.result = {"trial": loaded.name, "runs": [run_entry(result)]}
        leaves.write_junit([(loaded.name, result)])
        _print_page(leaves.page(lambda: write_report(result.folder, play=play), [result]))
    _exit_with([result])


@dataclass(frozen=True)
class How:
    """How the cases of a campaign are run."""

    engine: Engine
    jobs: int | None
    resume: bool


def _run_campaign(campaign: Campaign, out: Path | None, how: How, leaves: Leaves) -> None:
    cases = campaign.cases()
    with stoppable() as stop:
        with Watch(campaign.read_from.name) as watch:

            def done(case: Case, result: Result) -> None:
                watch.log(lambda: print_case(case, result))
                watch.count(failed=not result.passed)

            hooks = Hooks(
                building=watch.building,
                progress=watch.campaign,
                stop_requested=stop.requested,
                interruptible=stop.interruptible,
            )
            watch.expect(len(cases))
            folder, finished = run_campaign(
                campaign,
                out,
                **vars(how),
                page=partial(write_case_report, play=play) if leaves.report else None,
                hooks=hooks,
                done=done,
            )
        results = [result for _, result in finished]
        page = leaves.page(lambda: write_campaign_report(folder), results)
        leaves.write_junit([(case.name, result) for case, result in finished])
    passed = sum(result.passed for _, result in finished)
    console.print(f"{passed} of {len(cases)} cases pass")
    entries = [{"case": case.name, "set": case.set, **run_entry(r)} for case, r in finished]
    answer.result = {"campaign": campaign.read_from.name, "folder": str(folder), "runs": entries}
    _print_page(page)
    whole = sum(result.status != "stopped" for _, result in finished)
    if whole < len(cases):
        raise SimulationError(
            f"stopped; {whole} of {len(cases)} cases came to an end: "
            f"--out {folder} --resume goes on"
        )
    _exit_with([result for _, result in finished])


@dataclass(frozen=True)
class Leaves:
    """What a command leaves besides run folders."""

    junit: Path | None
    report: bool

    def page(self, write: Callable[[], Path], results: list[Result]) -> Path | None:
        """Write a page and return where; None if none is wanted, or of runs that have failed.

        Raises SimulationError: nothing that a person wrote is wrong with it.
        """
        if not self.report:
            return None
        try:
            return write()
        except (OSError, InputError) as error:
            where = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else error
            message = f"cannot write the report: {where}"
            if not any(result.status == "failed" for result in results):
                raise SimulationError(message) from None
            print_notes([message])
            return None

    def write_junit(self, runs: list[tuple[str, Result]]) -> None:
        """Write the JUnit file, if one is wanted. Raises OSError."""
        if self.junit is not None:
            write_junit(self.junit, runs)


def _print_page(page: Path | None) -> None:
    if page is not None:
        console.print(f"report: {page}", soft_wrap=True)


def _paced(trial: Trial, pace: dict[str, Any]) -> Trial:
    """Return the trial with what the command line says of real time."""
    if not pace:
        return trial
    if "factor" not in pace and trial.file.real_time is None:
        raise InputError("--overrun needs --real-time, or real_time in the trial")
    return trial.in_real_time(pace, "command line: real_time")


def _exit_with(results: list[Result]) -> None:
    if any(result.status == "failed" for result in results):
        first = next(result.error for result in results if result.status == "failed")
        raise SimulationError(str(first))
    if any(result.status == "stopped" for result in results):
        raise SimulationError("stopped; the signals recorded so far are on disk")
    if not all(result.passed for result in results):
        raise typer.Exit(FAILED)
