"""Rigs and trials as packages for other tools: SSP, and OSP-IS."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.model.component import seconds
from seatrial.system.assembling.assembly import assemble
from seatrial.system.system import System
from seatrial.trial.files.trial import Trial, is_trial, load_trial

from .osp.writing import write_osp
from .rig_changes import changed_rig, set_values
from .ssp.describing import Experiment
from .ssp.shapes import Version
from .ssp.tools import takes_systems
from .ssp.writing import write_ssp

_USUAL_STOP = 10.0
"""Stop time in the package of a rig, which has none itself, s."""


def export_ssp(
    name: str,
    out: Path | None = None,
    variant: str | None = None,
    *,
    changes: Mapping[str, Any] | None = None,
    tool: str | None = None,
    version: Version = "1.0",
) -> tuple[Path, list[str]]:
    """Write the trial or rig ``name`` as an SSP package of ``version``; return its path and notes.

    ``name`` is a shipped name or a path; where a trial and a rig share it, the trial is meant.
    The package is ``out``, or ``NAME.ssp`` in the current folder. ``changes`` are those of
    `Trial.changed`; of a rig its step, algorithm, ``choices.NAME`` and ``component.port``.
    Rigs inside rigs are systems inside systems, unless ``tool``, one of `TOOLS`, takes none.
    The notes say what SSP cannot. Raises InputError.
    """
    in_one = tool is not None and not takes_systems(tool)
    system, experiment, notes = _opened(name, variant, changes or {})
    path = out or Path(f"{experiment.name}.ssp")
    try:
        if path.resolve() == Path(name).resolve():
            raise InputError(f"{path} would replace what it is made from; name another with --out")
        notes += write_ssp(system, experiment, path, in_one=in_one, version=version)
    finally:
        system.discard()
    return path, notes


def export_osp(
    name: str,
    out: Path | None = None,
    variant: str | None = None,
    *,
    changes: Mapping[str, Any] | None = None,
) -> tuple[Path, list[str]]:
    """Write the trial or rig ``name`` for libcosim; return the folder and notes.

    The folder is ``out``, or ``NAME-osp`` in the current folder; the rest is as for
    `export_ssp`.
    """
    system, experiment, notes = _opened(name, variant, changes or {})
    folder = out or Path(f"{experiment.name}-osp")
    try:
        if folder.resolve() in (Path(name).resolve(), Path(name).resolve().parent):
            raise InputError(
                f"{folder} would replace what it is made from; name another with --out"
            )
        notes += write_osp(system, experiment, folder)
    finally:
        system.discard()
    return folder, notes


def _opened(
    name: str, variant: str | None, changes: Mapping[str, Any]
) -> tuple[System, Experiment, list[str]]:
    """Return a trial or rig assembled, its name and times, and what no package can say of it."""
    if is_trial(name):
        if variant is not None:
            changes = {**changes, "variant": variant}
        trial = load_trial(name, changes=changes, origin="--set")
        times = seconds(trial.start_ns), seconds(trial.stop_ns)
        return _set_up(trial), Experiment(trial.name, *times), [*trial.notes, *_unsaid(trial)]
    rig = changed_rig(name, changes)
    system = assemble(rig, "fmu", variant=variant)
    try:
        set_values(system, changes)
    except BaseException:
        system.discard()
        raise
    notes = [f"a rig has no stop time: the package says {_USUAL_STOP:g} s"]
    return system, Experiment(rig.read_from.name, 0.0, _USUAL_STOP), notes


def _set_up(trial: Trial) -> System:
    """Return the assembled rig of ``trial`` with everything that the trial sets."""
    file = trial.file
    system = assemble(trial.rig, "fmu", variant=file.variant, seed=file.seed)
    try:
        trial = trial.dated(system)
        trial.surround(system)
        for setting in trial.settings():
            system.set(*setting)
    except BaseException:
        system.discard()
        raise
    return system


def _unsaid(trial: Trial) -> list[str]:
    """Return what packages cannot say of a trial."""
    file = trial.file
    entries = {
        "events": file.events,
        "faults": file.faults,
        "criteria": file.criteria,
        "events of the scenario": trial.scenario,
    }
    return [f"{kind} are not in the package: it has none" for kind, of in entries.items() if of]
