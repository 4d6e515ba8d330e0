"""Rigs and trials as SSP packages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..component import seconds
from ..cosim.assembly import assemble
from ..cosim.flattening import load_rig
from ..cosim.ssp.describing import Experiment
from ..cosim.ssp.shapes import Version
from ..cosim.ssp.tools import takes_systems
from ..cosim.ssp.writing import write_ssp
from ..cosim.system import System
from ..errors import InputError
from .trial import Trial, is_trial, load_trial

_USUAL_STOP = 10.0
"""Stop time in the package of a rig, which has none itself, s."""


def export_ssp(
    name: str,
    out: Path | None = None,
    variant: str | None = None,
    *,
    choices: Mapping[str, str] | None = None,
    tool: str | None = None,
    version: Version = "1.0",
) -> tuple[Path, list[str]]:
    """Write the trial or rig ``name`` as an SSP package of ``version``; return its path and notes.

    ``name`` is a shipped name or a path; where a trial and a rig share it, the trial is meant.
    The package is ``out``, or ``NAME.ssp`` in the current folder. ``choices`` are of the rig.
    Rigs inside rigs are systems inside systems, unless ``tool``, one of `TOOLS`, takes none.
    The notes say what SSP cannot. Raises InputError.
    """
    in_one = tool is not None and not takes_systems(tool)
    if is_trial(name):
        changes = {f"choices.{key}": value for key, value in (choices or {}).items()}
        if variant is not None:
            changes["variant"] = variant
        trial = load_trial(name, changes=changes, origin="--choose, --variant")
        system, notes = _set_up(trial), [*trial.notes, *_unsaid(trial)]
        start, stop = seconds(trial.start_ns), seconds(trial.stop_ns)
        title = trial.name
    else:
        rig = load_rig(name, choices=choices)
        system = assemble(rig, "fmu", variant=variant)
        notes = [f"a rig has no stop time: the package says {_USUAL_STOP:g} s"]
        start, stop, title = 0.0, _USUAL_STOP, rig.read_from.name
    path = out or Path(f"{title}.ssp")
    try:
        if path.resolve() == Path(name).resolve():
            raise InputError(f"{path} would replace what it is made from; name another with --out")
        notes += write_ssp(
            system, Experiment(title, start, stop), path, in_one=in_one, version=version
        )
    finally:
        system.free()
    return path, notes


def _set_up(trial: Trial) -> System:
    """Return the assembled rig of ``trial`` with everything that the trial sets."""
    file = trial.file
    system = assemble(trial.rig, "fmu", variant=file.variant, seed=file.seed)
    try:
        for key, written, origin in trial.settings():
            system.set(key, written, origin)
    except BaseException:
        system.free()
        raise
    return system


def _unsaid(trial: Trial) -> list[str]:
    """Return what SSP cannot say of a trial."""
    return [
        f"{kind} are not in the package: SSP has none"
        for kind, entries in (("events", trial.file.events), ("criteria", trial.file.criteria))
        if entries
    ]
