"""Running a trial: from its files to a run folder with signals, manifest and verdicts."""

from __future__ import annotations

import contextlib
import shutil
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ...sim.master import Master
from ...system.assembling.shape_ports import MESHES
from ...system.part import Part
from ...system.system import Engine, System
from ..criteria.verdict import Verdict
from ..files.trial import Trial
from ..records.ending import is_whole
from .generators import own_generators
from .hooks import Hooks, StoppedError
from .output import claim_folder
from .preparation import prepare
from .simulation import Run

__all__ = ["Hooks", "Result", "StoppedError", "check_trial", "run_trial"]


@dataclass
class Result:
    """A finished run."""

    folder: Path
    status: str
    """complete, ended (by a criterion), ended by COMPONENT, stopped or failed."""
    error: str | None
    verdicts: list[tuple[str, str, Verdict]]
    """(name, check, verdict) of each criterion; empty if the run failed or was stopped."""
    notes: list[str]
    """What the user should know: of the rig, of the steps, of the pace."""
    wall: dict[str, float] = field(default_factory=dict)
    seed: int = 0
    figures: list[list[float]] = field(default_factory=list)
    """Least, greatest and last value of each of the trial's figures, as `verdicts`."""

    @property
    def passed(self) -> bool:
        """True if the run came to an end of its own and every criterion is as expected."""
        return is_whole(self.status) and all(v.as_expected for _, _, v in self.verdicts)


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
    wall: dict[str, float] = {}
    here = Path.cwd()  # a component may change it
    with hooks.interruptible(), _timed(wall, "assemble"):
        prepared = prepare(trial, engine, hooks)
    with own_generators(prepared.system.seed):
        try:
            hooks.assembled(prepared.system, prepared.manifest)
            with hooks.interruptible(), _timed(wall, "initialise"):
                master = prepared.started()
            hooks.refuse_if_stopped()
            folder = claim_folder(out, trial.name, "manifest.json", here)
            hooks.claimed(folder)
            _copy_meshes(prepared.system, folder)
            _set_run_folder(master, folder)
            run = Run(prepared, master, folder, hooks, wall)
            if trial.file.real_time is not None:
                _report_addresses(master, hooks)
            run.simulate()
        except BaseException:
            with contextlib.suppress(KeyboardInterrupt), hooks.interruptible():
                prepared.system.discard()
            raise
        run.release()
    verdicts = [] if run.status in ("failed", "stopped") else run.evaluate()
    figures = [] if run.status in ("failed", "stopped") else run.stepping.figures()
    seed = prepared.system.seed
    return Result(folder, run.status, run.error, verdicts, run.notes(), wall, seed, figures)


def check_trial(trial: Trial, engine: Engine = "fmu", hooks: Hooks | None = None) -> bool:
    """Raise InputError for what `run_trial` would refuse before it starts the components.

    Return whether it must run alone: it keeps to wall time, or programs outside connect to it.
    """
    system = prepare(trial, engine, hooks or Hooks()).system
    try:
        return trial.file.real_time is not None or any(
            _has_links(part) for part in system.parts.values()
        )
    finally:
        system.discard()


def _has_links(part: Part) -> bool:
    """Say if programs outside can connect to a component."""
    if not part.instance.variables.of_role("address"):
        return False
    links = part.instance.variables.get("links")
    given = part.given.get("links")
    value = given.value if given else links.start if links else ""
    return links is None or bool(value)


@contextlib.contextmanager
def _timed(wall: dict[str, float], what: str) -> Iterator[None]:
    """Note the wall time of a block, s."""
    begun = time.perf_counter()
    yield
    wall[what] = time.perf_counter() - begun


def _copy_meshes(system: System, folder: Path) -> None:
    """Copy the files that the vehicles' shapes show to the run's folder, which is then whole."""
    for part in system.parts.values():
        for name, path in part.meshes.items():
            (folder / MESHES).mkdir(exist_ok=True)
            shutil.copyfile(path, folder / MESHES / name)


def _set_run_folder(master: Master, out: Path) -> None:
    """Set the run's folder as that of the logs, in components whose folder is not set."""
    for name, part in master.system.parts.items():
        for port in part.instance.variables.of_role("run-folder"):
            if port not in part.given:
                master.set(name, [port], [str(out.resolve())])


def _report_addresses(master: Master, hooks: Hooks) -> None:
    """Report which components programs outside connect to, and where."""
    for name, part in master.system.parts.items():
        for port in part.instance.variables.of_role("address"):
            (where,) = part.instance.reader([port])()
            if where:
                hooks.reachable(name, str(where))
