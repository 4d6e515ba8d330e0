"""Running a trial: from its files to a run folder with signals, manifest and verdicts."""

from __future__ import annotations

import contextlib
import datetime
import itertools
import json
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ..component import Logging, Reachable, seconds
from ..cosim.master import Master
from ..cosim.recorder import Recorder
from ..cosim.system import Engine, System, assemble
from ..cosim.values import from_written, port_scalars
from ..errors import InputError, SimulationError
from .checks import check_criteria, check_events, check_plots, check_real_time
from .manifest import manifest
from .pacing import Pace
from .termination import TerminationConditions
from .trial import Event, Trial
from .verdict import Verdict

Progress = Callable[[float, float], None]
"""Called now and then with the simulated time that has passed, and that of the whole run, s."""


@dataclass(frozen=True)
class Hooks:
    """What a caller may watch or stop."""

    building: Callable[[str], None] = lambda _: None
    progress: Progress = lambda _passed, _whole: None
    stop_requested: Callable[[], bool] = lambda: False
    interruptible: Callable[[], AbstractContextManager[object]] = nullcontext
    """Around what a component may never return from: elsewhere no signal raises anything."""
    reachable: Callable[[str, str], None] = lambda _name, _where: None
    """In real time: a component that programs outside connect to, and where."""


class StoppedError(SimulationError):
    """A run was stopped before it began: it left nothing."""


@dataclass
class Result:
    """A finished run."""

    folder: Path
    status: str
    """complete, ended (by a criterion), stopped or failed."""
    error: str | None
    verdicts: list[tuple[str, str, Verdict]]
    """(name, check, verdict) of each criterion; empty if the run failed."""
    notes: list[str]
    """What the user should know: of the rig, of the steps, of the pace."""
    wall: dict[str, float] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """True if the run is complete and every criterion holds."""
        return self.status == "complete" and all(v.passed for _, _, v in self.verdicts)


def run_trial(
    trial: Trial, out: Path | None, *, engine: Engine = "fmu", hooks: Hooks | None = None
) -> Result:
    """Run ``trial`` and leave the run folder ``out``, which must not hold anything yet.

    None makes a new folder ``runs/NAME-DATE-TIME``.

    Everything written in the trial's files is checked, and the components are started, before
    ``out`` is made. A run that fails or is stopped afterwards leaves the signals recorded so
    far, and says so in its manifest.

    Raises InputError for bad input, or a rig that cannot start with it; StoppedError.
    """
    hooks = hooks or Hooks()
    begun = time.perf_counter()
    with hooks.interruptible():
        system, units = _prepared(trial, engine, hooks)
    try:
        wall = {"assemble": time.perf_counter() - begun}
        with hooks.interruptible():
            master = _started(trial, system, wall)
        _refuse_if_stopped(hooks)
        out = claim_folder(out, trial.name, "manifest.json")
        _tell_folder(master, out)
        recorder = Recorder(
            out / "signals.csv",
            master,
            trial.file.record.signals,
            trial.record_every,
            sorted(set().union(*(criterion.signals for _, criterion in trial.criteria))),
        )
        entry, termination = trial.file.real_time, TerminationConditions(trial, master, units)
        pace = None if entry is None else Pace(entry, master)
        if pace is not None:
            _tell_reachable(master, hooks)
        status, error = _simulate(
            trial, master, recorder, termination, pace, out, engine, hooks, wall
        )
    finally:
        with contextlib.suppress(KeyboardInterrupt), hooks.interruptible():
            system.free()  # nothing of the run depends on it any more
    verdicts = [] if status == "failed" else _evaluate(trial, recorder, out, units)
    notes = [*_loose_inputs(trial, system), *master.notes()]
    if pace is not None:
        notes.append(pace.pacer.note())
    return Result(out, status, error, verdicts, notes, wall)


def _tell_folder(master: Master, out: Path) -> None:
    """Say where the run's folder is to the components that keep logs and were told nothing."""
    for name, part in master.system.parts.items():
        port = part.instance.variables.get("run_folder")
        keeps_logs = port is not None and port.description == Logging.run_folder.description
        if keeps_logs and "run_folder" not in part.given:
            master.set(name, ["run_folder"], [str(out.resolve())])


def _tell_reachable(master: Master, hooks: Hooks) -> None:
    """Say which components programs outside connect to, and where."""
    for name, part in master.system.parts.items():
        port = part.instance.variables.get("reached_at")
        if port is not None and port.description == Reachable.reached_at.description:
            (where,) = part.instance.reader(["reached_at"])()
            if where:
                hooks.reachable(name, str(where))


def _loose_inputs(trial: Trial, system: System) -> list[str]:
    """Return a note on the inputs that neither a wire nor an event reaches, if there are any."""
    moved = {event.key for event in trial.events()}
    loose = [name for name in system.unconnected_inputs() if name not in moved]
    said = f"inputs that nothing feeds keep their start values: {', '.join(loose)}"
    return [said] if loose else []


def _refuse_if_stopped(hooks: Hooks) -> None:
    if hooks.stop_requested():
        raise StoppedError("stopped before the run began; nothing was written")


def claim_folder(out: Path | None, name: str, index: str) -> Path:
    """Create the folder of a run for this process alone, and return it.

    None makes a new one, ``runs/NAME-DATE-TIME``; else ``out`` must not hold anything yet.
    ``index`` is the file that claims the folder. Raises InputError.
    """
    try:
        if out is None:
            return _new_folder(name)
        out.mkdir(parents=True, exist_ok=True)
        if any(out.iterdir()):
            raise FileExistsError
        (out / index).open("x").close()
    except (FileExistsError, NotADirectoryError):
        message = f"{out} exists and is not an empty folder; name another with --out"
        raise InputError(message) from None
    except OSError as error:
        raise InputError(f"cannot create {out or 'runs'}: {error.strerror}") from None
    return out


def _new_folder(name: str) -> Path:
    stamp = datetime.datetime.now().strftime("%Y%m%d-%H%M%S")
    for count in itertools.count(1):
        folder = Path("runs") / (f"{name}-{stamp}" + (f"-{count}" if count > 1 else ""))
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        return folder
    raise AssertionError("unreachable")


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file whole or not at all."""
    temporary = path.with_suffix(".tmp")
    temporary.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")
    temporary.replace(path)


def check_trial(trial: Trial, engine: Engine = "fmu", hooks: Hooks | None = None) -> None:
    """Raise InputError for what `run_trial` would refuse before it starts the components."""
    system, _ = _prepared(trial, engine, hooks or Hooks())
    system.free()


def _prepared(trial: Trial, engine: Engine, hooks: Hooks) -> tuple[System, dict[str, str]]:
    """Return the assembled system, everything set, and the units of its signals."""

    def building(what: str) -> None:
        _refuse_if_stopped(hooks)
        hooks.building(what)

    system = assemble(
        trial.rig,
        engine,
        variant=trial.file.variant,
        seed=trial.file.seed,
        progress=building,
    )
    try:
        for key, written, origin in trial.settings():
            system.set(key, written, origin)
        for key, factor, origin in trial.scales:
            system.scale(key, factor, origin)
        units = check_criteria(trial, system)
        check_plots(trial, system)
        check_events(trial, system)
        check_real_time(trial, system)
    except BaseException:
        system.free()
        raise
    return system, units


def _started(trial: Trial, system: System, wall: dict[str, float]) -> Master:
    begun = time.perf_counter()
    master = Master(system, trial.start_ns, trial.stop_ns)
    try:
        master.initialise()
    except SimulationError as error:
        raise InputError(f"{trial.rig.read_from.path}: the rig cannot start: {error}") from None
    wall["initialise"] = time.perf_counter() - begun
    return master


def _simulate(
    trial: Trial,
    master: Master,
    recorder: Recorder,
    termination: TerminationConditions,
    pace: Pace | None,
    out: Path,
    engine: Engine,
    hooks: Hooks,
    wall: dict[str, float],
) -> tuple[str, str | None]:
    content = manifest(trial, master.system, engine)
    write_json(out / "manifest.json", {**content, "status": "running", "error": None})
    started = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    begun = time.perf_counter()
    status = "failed"
    error: str | None = "ended by an error of seatrial itself"
    try:
        with hooks.interruptible():
            status, error = _loop(trial, master, recorder, termination, pace, hooks), None
    except SimulationError as problem:
        error = str(problem)
    except KeyboardInterrupt:
        status, error = "stopped", None
    except OSError as problem:
        error = f"cannot write {out / 'signals.csv'}: {problem.strerror}"
    finally:
        wall["run"] = time.perf_counter() - begun
        with contextlib.suppress(OSError):  # the disk may be full: what was recorded stays
            recorder.close()
            write_json(out / "timing.json", _timing(master, pace, started, wall))
            write_json(out / "manifest.json", {**content, "status": status, "error": error})
    return status, error


def _timing(
    master: Master, pace: Pace | None, started: str, wall: dict[str, float]
) -> dict[str, Any]:
    simulated = seconds(master.time_ns - master.start_ns)
    content = {
        "started": started,
        "wall_s": wall,
        "simulated_s": simulated,
        "steps": master.steps,
        "real_time_factor": simulated / wall["run"],
        "step_times": {name: times.as_json() for name, times in master.step_times.items()},
    }
    return content if pace is None else {**content, "pacing": pace.pacer.as_json()}


def _loop(
    trial: Trial,
    master: Master,
    recorder: Recorder,
    termination: TerminationConditions,
    pace: Pace | None,
    hooks: Hooks,
) -> str:
    events, status = trial.events(), "complete"
    whole, steps = seconds(trial.stop_ns - trial.start_ns), trial.steps
    shown = time.perf_counter()
    if pace is not None:
        pace.start()
    while True:
        while events and events[0].at_ns <= master.time_ns:
            _apply(events.pop(0), master)
        stopping, broken = hooks.stop_requested(), termination.broken()
        recorder.record(last=stopping or broken or master.steps >= steps)
        if broken:
            status = "ended"
            break
        if stopping and master.steps < steps:
            return "stopped"
        if master.steps >= steps:
            break
        if pace is None:
            master.step()
        else:
            pace.step(recorder, hooks.stop_requested)
        if (pace or master.steps % 16 == 0) and time.perf_counter() - shown > 0.1:
            shown = time.perf_counter()
            hooks.progress(seconds(master.time_ns - master.start_ns), whole)
    hooks.progress(whole, whole)
    master.terminate()
    return status


def _apply(event: Event, master: Master) -> None:
    component, _, port = event.key.partition(".")
    variables = master.system.parts[component].instance.variables
    scalars = port_scalars(variables, port)
    if event.action == "release":
        for variable in scalars:
            master.release(component, variable.name)
        return
    presets = master.system.parts[component].presets.get(port, {})
    given = from_written(event.written, scalars, presets, f"event {event.key}")
    if event.action == "set":
        master.set(component, list(given), [g.value for g in given.values()])
    else:
        for name, value in given.items():
            master.override(component, name, value.value)


def _evaluate(
    trial: Trial, recorder: Recorder, out: Path, units: dict[str, str]
) -> list[tuple[str, str, Verdict]]:
    """Evaluate every communication step, however often rows were recorded."""
    t, signals = recorder.watched()
    verdicts = []
    for entry, (name, criterion) in zip(trial.file.criteria, trial.criteria, strict=True):
        verdicts.append((name, entry.check, criterion.evaluate(t, signals, units)))
    rows = [{"name": name, "check": check, **asdict(verdict)} for name, check, verdict in verdicts]
    write_json(out / "verdicts.json", rows)
    return verdicts
