"""``seatrial run``: a trial, a vehicle in the trial for every vehicle, or a campaign."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ...errors import InputError, unknown
from ...files.reading import toml_content
from ...files.vehicle_folders import FOLDERS, place_in
from ...links.hardware import allow_devices, allow_network
from ...plugins import service
from ...shipped import available
from ...system.fault_entry import read_fault
from ...system.packages import is_package
from ...system.system import Engine
from ...trial.files.limit_entry import NONE, limits_of
from ...trial.files.trial import Trial, load_trial
from ...trial.reports.playing import play
from ...trial.reports.report import write_report
from ...trial.running.hooks import Hooks
from ...trial.running.supervision import run_supervised
from ...trial.running.twice import First, check_repeatable, has_ended
from ..answer import answer
from ..leaves import Leaves, exit_with
from ..options import (
    Autopilot,
    Choices,
    EngineName,
    Faults,
    Hardware,
    Network,
    Out,
    Settings,
    Vehicle,
    changes_of,
    engine_named,
    is_campaign,
)
from ..show import print_notes, print_reachable, print_verdicts, run_entry
from ..stopping import stoppable
from ..watch import Watch
from .run_options import (
    Cluster,
    Jobs,
    Junit,
    KeepGoing,
    KeepName,
    Limit,
    Live,
    LiveControl,
    NoReport,
    Open,
    Overrun,
    Port,
    RealTime,
    Record,
    RerunChanged,
    Resume,
    Twice,
)
from .twice import exit_unless, repeat

_OF_CAMPAIGNS = (
    "--jobs, --resume, --rerun-changed, --keep and --cluster work with a campaign; a trial is one "
    "run"
)
_WITH_LIVE = "--port, --open and --live-control go with --live"


def run(
    trial: Annotated[
        str,
        typer.Argument(
            help="A trial, campaign or vehicle: a name, a file or a package.",
            autocompletion=runnable,
        ),
    ],
    settings: Settings = None,
    faults: Faults = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    engine: EngineName = "fmu",
    out: Out = None,
    real_time: RealTime = None,
    overrun: Overrun = None,
    hardware: Hardware = False,
    network: Network = False,
    record: Record = "trial",
    junit: Junit = None,
    jobs: Jobs = None,
    resume: Resume = False,
    rerun_changed: RerunChanged = False,
    live: Live = False,
    port: Port = 0,
    open_: Open = False,
    live_control: LiveControl = False,
    cluster: Cluster = None,
    keep: KeepName = None,
    no_report: NoReport = False,
    limit: Limit = None,
    twice: Twice = False,
    keep_going: KeepGoing = False,
) -> None:
    """Run a trial, a campaign of trials, or a vehicle that sets out, and say what holds."""
    chosen = engine_named(engine)
    _allow(hardware, network, keep_going, twice)
    limits = limits_of(limit or [], "--limit")
    changes = changes_of(settings, choices, vehicle, autopilot)
    paced = {"factor": real_time, "overrun": overrun}.items()
    pace = {key: value for key, value in paced if value is not None}
    page = service("live.page_of")(port, open_, hardware, live_control) if live else None
    _refuse_first({_WITH_LIVE: not live and (port or open_ or live_control)})
    leaves = Leaves(junit, not no_report)
    if is_campaign(trial):
        of_trials = {
            "--live works with a trial, not with a campaign": live,
            "--fault works with a trial; a campaign has faults of its own": faults,
            "--real-time and --overrun work with a trial, not with a campaign": pace,
            "--record works with a trial, not with a campaign": record != "trial",
            "--resume needs the campaign's folder, --out FOLDER": resume and out is None,
            "--rerun-changed goes with --resume": rerun_changed and not resume,
        }
        _refuse_first(of_trials)
        service("campaigns.run_named")(
            trial,
            changes,
            limits,
            out,
            leaves,
            engine=chosen,
            jobs=jobs,
            resume=resume,
            rerun_changed=rerun_changed,
            cluster=cluster,
            keep=keep,
            keep_going=keep_going,
            twice=twice,
            check=partial(_refuse_endless, hardware=hardware),
        )
        return
    if jobs is not None or resume or rerun_changed or keep or cluster:
        raise InputError(_OF_CAMPAIGNS)
    trial, changes = with_vehicle(trial, changes)
    loaded = load_trial(trial, changes=changes, origin="--set")
    loaded = loaded.failing([read_fault(text, "--fault") for text in faults or []], "--fault")
    loaded = _paced(loaded, pace).recording(record, "--record").limited(limits, "--limit")
    _refuse_endless([loaded], hardware)
    if twice:
        check_repeatable(loaded)
    _run_trial(loaded, out, chosen, page, leaves, keep_going, twice=twice)


def _refuse_first(given: Mapping[str, object]) -> None:
    """Raise InputError with the first refusal of which something is given."""
    for refusal, what in given.items():
        if what:
            raise InputError(refusal)


def _allow(hardware: bool, network: bool, keep_going: bool, twice: bool) -> None:
    """Allow devices and other hosts. Raises InputError for options that need devices."""
    if twice and hardware:
        raise InputError("--twice does not go with --hardware: no two runs with a device are alike")
    if keep_going and not hardware:
        raise InputError("--keep-going goes with --hardware: a simulation goes on in any case")
    if hardware:
        allow_devices()
    if network:
        allow_network()


def _refuse_endless(trials: list[Trial], hardware: bool) -> None:
    """Raise InputError for calls without a limit where devices are allowed."""
    if hardware and any(trial.file.limit.call == NONE for trial in trials):
        raise InputError("limit.call = none does not go with --hardware: a device needs a limit")


def _run_trial(
    trial: Trial,
    out: Path | None,
    engine: Engine,
    page: Any | None,
    leaves: Leaves,
    keep_going: bool,
    *,
    twice: bool,
) -> None:
    print_notes(trial.notes)
    with stoppable() as stop:
        with Watch(trial.name) as watch:
            hooks = Hooks(
                building=watch.building,
                progress=watch.progress,
                stop_requested=stop.requested,
                interruptible=stop.interruptible,
                reachable=print_reachable,
                keep_going=keep_going,
            )
            if page is None:
                result = run_supervised(trial, out, engine=engine, hooks=hooks)
            else:
                result = service("live.run_watched")(trial, out, engine, hooks, page)
        print_verdicts(result)
        answer.result = {"trial": trial.name, "runs": [run_entry(result)]}
        leaves.write_junit([(trial.name, result)])
        leaves.write_page(lambda: write_report(result.folder, play=play), [result])
        first = First(trial.name, trial, result.folder)
        is_same = not twice or not has_ended(result.status) or repeat([first], engine, stop)
    exit_with([result])
    exit_unless(is_same)


def _paced(trial: Trial, pace: dict[str, Any]) -> Trial:
    """Return the trial with what the command line says of real time."""
    if not pace:
        return trial
    if "factor" not in pace and trial.file.real_time is None:
        raise InputError("--overrun needs --real-time, or real_time in the trial")
    return trial.in_real_time(pace, "command line: real_time")


_MOST_NAMED = 8
_AUTOPILOT, _VEHICLE = "choices.autopilot", "choices.vehicle"
_FOR_EVERY = "under-"
"""Beginning of the names of trials for every vehicle."""
_SETTING_OUT = "under-way"


def runnable(beginning: str) -> list[str]:
    """Return what can be run whose name begins so, for a shell's completion."""
    names = {**available("harness/trials"), **available("harness/campaigns"), **_vehicles()}
    return sorted(name for name in names if name.startswith(beginning))


def with_vehicle(name: str, changes: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the trial that a name means, and the settings with the vehicle if it is one's.

    A vehicle's name means the trial for every vehicle under the autopilot that is chosen, else
    the one in which it sets out. A trial of that name comes first. Raises InputError for a rig's
    name, with its trials, for a vehicle's file that cannot be read, for two vehicles, and for a
    name that is none, with those like it.
    """
    trials = available("harness/trials")
    if name in trials or name.endswith(".toml") or is_package(name):
        return name, changes
    here = place_in(Path.cwd() / FOLDERS, "harness/rigs", f"vehicles/{name}")
    if here is not None or name in _vehicles():
        if (other := changes.get(_VEHICLE, name)) != name:
            raise InputError(f"{name!r} is a vehicle, and another one is chosen, {other!r}")
        trial = _trial_under(str(changes.get(_AUTOPILOT, "")))
        return trial, {_VEHICLE: name, **changes}
    if name in available("harness/rigs"):
        found = _trials_of(name)
        said = f"{name!r} is a rig, not a trial"
        if not found:
            raise InputError(f"{said}; no trial here is of it")
        more = f", and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
        raise InputError(f"{said}; its trials: {', '.join(found[:_MOST_NAMED])}{more}")
    known = [*trials, *available("harness/campaigns"), *_vehicles()]
    more = "; or give a path ending in .toml"
    raise InputError(f"{unknown('trial, campaign or vehicle', name, known)}{more}")


def _trial_under(autopilot: str) -> str:
    """Return the trial for every vehicle that has an autopilot, else the one of its pilot."""
    trials = available("harness/trials").items()
    for_every = [(name, path) for name, path in trials if name.startswith(_FOR_EVERY)]
    for name, path in for_every if autopilot else ():
        if _content(path).get("choices", {}).get("autopilot") == autopilot:
            return name
    return _SETTING_OUT


def _vehicles() -> dict[str, Path]:
    return available("harness/rigs/vehicles")


def _trials_of(rig: str) -> list[str]:
    trials = available("harness/trials").items()
    return [name for name, path in trials if Path(str(_content(path).get("rig", ""))).stem == rig]


def _content(path: Path) -> dict[str, Any]:
    try:
        return toml_content(path.read_bytes(), str(path))
    except (InputError, OSError):
        return {}
