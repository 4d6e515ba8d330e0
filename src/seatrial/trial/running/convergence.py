"""Step halving: a trial at its communication step, half of it, a quarter, and what differs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...errors import InputError, SimulationError
from ...model.component import seconds
from ...model.readable import number
from ...system.rig import Rig, Scope, duration_ns
from ...system.system import Engine
from ..files.trial import Trial
from ..records import run_schema
from ..records.accuracy import Accuracy, accuracy, ranked
from ..records.run_folder import Run, load_run
from ..records.run_schema import checked_json
from .hooks import Hooks
from .output import write_json
from .run import Result
from .supervision import Supervisor

CONVERGENCE = "convergence.json"


@dataclass(frozen=True)
class Discrete:
    """An output without an order: Integer, Boolean or String."""

    signal: str
    differs_at: list[float | None]
    """First time at which the runs at each step and at half of it differ, s; None if nowhere."""


@dataclass(frozen=True)
class Convergence:
    """What step halving showed, and where its runs are."""

    trial: str
    steps: list[float]
    """Communication steps of the runs, s, the trial's own first."""
    folders: list[str]
    """Of the runs, relative to the first one's."""
    outputs: list[Accuracy]
    """Real outputs, the worst first."""
    discrete: list[Discrete]
    """Other outputs that differ between two runs."""
    components: list[str]
    """Of the rig, by path."""

    @property
    def converges(self) -> bool:
        """True if every Real output converges or is exact."""
        return all(output.behaviour != "not converging" for output in self.outputs)


def run_convergence(
    trial: Trial,
    out: Path | None,
    *,
    halvings: int = 2,
    engine: Engine = "fmu",
    hooks: Hooks | None = None,
    done: Callable[[Result], None] = lambda _: None,
) -> tuple[Path, Convergence]:
    """Run ``trial`` at its communication step and at ever halved ones, and compare the outputs.

    ``out``, which must not hold anything yet, becomes the run folder of the trial's own step,
    with ``convergence.json`` in it and the other runs in folders below; None makes a new
    ``runs/NAME-DATE-TIME``. ``done`` is called after each run. Rows are those of the trial's own
    step, whatever the step. All runs are free, whatever the trial has under ``real_time``.

    Raises InputError for bad input, SimulationError if a run fails or is stopped.
    """
    if halvings < 2:
        raise InputError(f"--halvings: at least 2 are needed to see an order, found {halvings}")
    if trial.rig.file.algorithm == "ecco":
        raise InputError(
            f"{trial.rig.read_from.path}: ecco chooses its steps by their energy residual, not "
            "by the communication step; compare runs with other values of ecco.absolute_tolerance"
        )
    trials = [_halved(trial, count) for count in range(halvings + 1)]
    folders: list[Path] = []
    with Supervisor(trials, engine, hooks) as supervisor:
        for number, one in enumerate(trials):
            result = supervisor.run(number, folders[0] / _folder_name(one) if folders else out)
            done(result)
            if result.status != "complete":
                why = result.error or f"{result.status}; the signals recorded so far are on disk"
                raise SimulationError(f"at a step of {_step_text(one)}: {why}")
            folders.append(result.folder)
    found = _compared(trials, [load_run(folder) for folder in folders])
    write_json(folders[0] / CONVERGENCE, asdict(found))
    return folders[0], found


def load_convergence(folder: Path) -> Convergence | None:
    """Return what step halving left in a run folder, None if nothing. Raises InputError."""
    path = folder / CONVERGENCE
    if not path.is_file():
        return None
    content = checked_json(path, run_schema.CONVERGENCE)
    content["outputs"] = [Accuracy(**output) for output in content["outputs"]]
    content["discrete"] = [Discrete(**output) for output in content["discrete"]]
    return Convergence(**content)


def _halved(trial: Trial, count: int) -> Trial:
    """Return the trial with all communication steps halved ``count`` times, but the same rows."""
    rig, parts = trial.rig, 2**count
    top = _refined(rig.top, parts)
    step = _part_of(rig.step_ns, parts, f"{rig.read_from.path}: step")
    top = replace(top, file=top.file.model_copy(update={"step": step}))
    every = f"{trial.record_every * trial.rig.step_ns} ns"
    record = trial.file.record.model_copy(update={"every": every})
    return replace(
        trial,
        rig=Rig(top.file, rig.read_from, top, rig.feeds),
        file=trial.file.model_copy(update={"record": record, "real_time": None}),
    )


def _refined(scope: Scope, parts: int) -> Scope:
    """Return a rig with the components' own steps divided, in the rigs inside it too."""
    components = {}
    for name, entry in scope.file.components.items():
        if entry.step is not None:
            key = f"{scope.read_from.path}: components.{name}.step"
            step = _part_of(duration_ns(entry.step, key), parts, key)
            entry = entry.model_copy(update={"step": step})
        components[name] = entry
    file = scope.file.model_copy(update={"components": components})
    inner = {name: _refined(each, parts) for name, each in scope.inner.items()}
    return replace(scope, file=file, inner=inner)


def _part_of(length_ns: int, parts: int, where: str) -> str:
    part, rest = divmod(length_ns, parts)
    if rest:
        raise InputError(
            f"{where}: {length_ns} ns is not a whole number of nanoseconds times {parts}"
        )
    return f"{part} ns"


def _step_text(trial: Trial) -> str:
    return f"{number(trial.rig.step_ns / 1e6, 9)} ms"


def _folder_name(trial: Trial) -> str:
    return f"step-{_step_text(trial).replace(' ', '')}"


def _compared(trials: Sequence[Trial], runs: Sequence[Run]) -> Convergence:
    finest = runs[-1]
    kinds = {name: described["type"] for name, described in finest.manifest["signals"].items()}
    real = [name for name in finest.signals if kinds[name] == "Real"]
    sizes: dict[str, float] = {}
    for name in real:
        size = max(float(np.max(np.abs(run.signals[name]))) for run in runs)
        unit = finest.units[name]
        sizes[unit] = max(sizes.get(unit, 0.0), size)
    outputs = [
        accuracy(name, unit := finest.units[name], [r.signals[name] for r in runs], sizes[unit])
        for name in real
    ]
    discrete = [_discrete(name, runs) for name in finest.signals if kinds[name] != "Real"]
    return Convergence(
        trial=trials[0].name,
        steps=[seconds(trial.rig.step_ns) for trial in trials],
        folders=[".", *(_folder_name(trial) for trial in trials[1:])],
        outputs=ranked(outputs),
        discrete=[one for one in discrete if any(at is not None for at in one.differs_at)],
        components=list(finest.manifest["components"]),
    )


def _discrete(name: str, runs: Sequence[Run]) -> Discrete:
    differs_at: list[float | None] = []
    for a, b in pairwise(runs):
        unequal = np.asarray(a.signals[name]) != np.asarray(b.signals[name])
        differs_at.append(float(a.time[np.argmax(unequal)]) if unequal.any() else None)
    return Discrete(name, differs_at)
