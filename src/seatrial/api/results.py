"""Trials run whole: what a run leaves, in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, SimulationError
from .written import as_engine, as_settings

if TYPE_CHECKING:
    from ..system.system import Engine
    from ..trial.files.trial import Trial
    from ..trial.records.run_folder import Run
    from .signals import Signals


@dataclass(frozen=True)
class Verdict:
    """Verdict on a criterion in a run."""

    name: str
    check: str
    """The condition, as the trial has it."""
    passed: bool
    detail: str
    """For a person: the worst value, when, and what was allowed; or why there is none."""
    worst: float | None
    """The value nearest to the limit or furthest beyond it; the settling time of ``settles``."""
    unit: str
    """Unit of ``worst``."""
    time: float | None
    """When that was, s."""
    robustness: float | None = None
    """Distance from the other verdict: positive if it holds; a share of the limit, or SI."""
    margin: str = ""
    """The same for a person."""
    expected: str = "pass"
    """``pass``, or ``fail`` of a criterion whose failure the trial expects."""
    why: str = ""
    """Why that is."""


class TrialResult:
    """A finished run: a view of its folder, which `run_trial` and `load_result` return.

    Raises InputError for a folder that is not a run.
    """

    def __init__(self, folder: Path | str, notes: tuple[str, ...] = ()) -> None:
        from ..trial.records.run_folder import read_manifest, read_verdicts

        self.folder = Path(folder)
        """The run folder: signals, manifest, verdicts and timing."""
        self.manifest: dict[str, Any] = read_manifest(self.folder)
        """Everything that decides the signals: versions, hashes, seeds, parameters, sources."""
        self.notes = notes
        """Remarks for the user on the rig and the steps; empty for a run read again."""
        self.verdicts: list[Verdict] = [
            Verdict(**{key: entry[key] for key in Verdict.__dataclass_fields__ if key in entry})
            for entry in read_verdicts(self.folder)
        ]
        """One per criterion, in the trial's order; empty if the run failed."""

    @property
    def name(self) -> str:
        """Name of the trial."""
        return str(self.manifest["trial"]["name"])

    @property
    def status(self) -> str:
        """End of the run.

        ``complete``; ``ended`` by a criterion; ``ended by COMPONENT``; ``stopped``, ``failed`` or
        still ``running``.
        """
        return str(self.manifest["status"])

    @property
    def passed(self) -> bool:
        """True if the run came to its end and every criterion is as expected: exit status 0."""
        from ..trial.records.ending import is_whole
        from ..trial.records.run_folder import is_as_expected

        counted = len(self.verdicts) == len(self.manifest["criteria"])
        return (
            is_whole(self.status)
            and counted
            and all(is_as_expected(vars(v)) for v in self.verdicts)
        )

    @cached_property
    def signals(self) -> Signals:
        """The recorded signals, read from ``signals.csv`` when first asked for.

        Raises InputError for a record that cannot be read.
        """
        import numpy as np

        from .arrays import SignalArray
        from .signals import Signals

        described, run = self.manifest["signals"], self._run
        types = {"Real": np.float64, "Integer": np.int64, "Boolean": np.bool_}

        def column(name: str) -> SignalArray:
            entry, values = described[name], run.signals[name]
            kind = types.get(entry.get("type", "Real"), np.object_)
            if isinstance(values, list):  # text; manifests of before have no types
                kind = np.object_
            return SignalArray(np.array(values, dtype=kind), entry["unit"], entry["description"])

        return Signals(list(run.signals), SignalArray(run.time, "s", "simulated time"), column)

    def report(self) -> Path:
        """Write ``report.html`` into the folder and return its path."""
        from ..trial.reports.playing import play
        from ..trial.reports.report import write_report

        return write_report(self.folder, play=play)

    @cached_property
    def _run(self) -> Run:
        from ..trial.records.run_folder import load_run

        return load_run(self.folder)

    def __repr__(self) -> str:
        failed = [verdict.name for verdict in self.verdicts if not verdict.passed]
        said = f"{len(failed)} of {len(self.verdicts)} criteria do not hold" if failed else "passed"
        if not self.passed and not failed:
            said = "not passed"
        return f"<{self.name}: {self.status}, {said}; {self.folder}>"


def run_trial(
    trial: str | Path,
    *,
    set: Mapping[str, Any] | None = None,
    faults: Sequence[Mapping[str, Any]] = (),
    out: str | Path | None = None,
    engine: str = "direct",
    progress: Callable[[float, float], None] | None = None,
) -> TrialResult:
    """Run a trial as ``seatrial run`` does, and return what it left.

    ``trial`` is a name, or a path of a ``.toml`` file, or of an SSP or OSP-IS package. ``set``
    changes it as ``--set`` does: ``component.port`` or ``variant``, ``seed``, ``start``, ``stop``,
    ``scenario``, ``step``, ``algorithm``, ``choices.NAME``; numbers in the port's unit (SI; s),
    text with a unit (``"10 deg"``), sequences and arrays with one element per axis.

    ``faults`` are more of the trial's ``faults``, a mapping of keys each, as in its file.

    The run leaves a folder, because a result without its manifest cannot be repeated: ``out``,
    which must not hold anything yet, or else a new one, ``runs/NAME-DATE-TIME``, below the
    current folder. The report is written when `TrialResult.report` is called.

    ``engine`` is ``"direct"``, components in process, ``"fmu"``, each as an FMU, or ``"native"``,
    as an FMU in C where there is one, else in process: the same numbers; rigs with ``.fmu`` files
    need one of the latter two. ``progress`` is called some ten times a second with the simulated
    time that has passed and that of the whole run, s. No device is opened and no other host
    reached; ``seatrial run`` can.

    The trial runs in a process of its own: a component that crashes or exits ends that, and the
    run has failed. On Windows it runs in this one.

    Raises InputError for bad input, before anything is written. Raises SimulationError for a run
    that could not go on, and KeyboardInterrupt for one that was interrupted; its folder holds
    what was recorded so far, for `load_result`.
    """
    from ..shipped import available
    from ..trial.files.trial import load_trial

    try:
        loaded = load_trial(str(trial), changes=as_settings(set), origin="set")
        loaded = loaded.failing([dict(each) for each in faults], "faults")
    except InputError as error:
        if trial in available("harness/campaigns") and trial not in available("harness/trials"):
            raise InputError(f"{trial} is a campaign: run_campaign runs it; {error}") from None
        raise
    return run_loaded(loaded, None if out is None else Path(out), as_engine(engine), progress)


def run_loaded(
    loaded: Trial,
    folder: Path | None,
    engine: Engine,
    progress: Callable[[float, float], None] | None = None,
) -> TrialResult:
    """Run a trial that was read; see `run_trial`, which raises the same."""
    from ..links.hardware import confined
    from ..trial.running.hooks import Hooks
    from ..trial.running.supervision import run_supervised

    hooks = Hooks() if progress is None else Hooks(progress=progress)
    with confined():
        result = run_supervised(loaded, folder, engine=engine, hooks=hooks)
    if result.status == "stopped":
        raise KeyboardInterrupt
    if result.status == "failed":
        raise SimulationError(f"{result.error}\n(what was recorded: {result.folder})")
    return TrialResult(result.folder, (*loaded.notes, *result.notes))


def load_result(folder: str | Path) -> TrialResult:
    """Read the folder that a run left, whoever made it. Raises InputError for another folder."""
    return TrialResult(folder)
