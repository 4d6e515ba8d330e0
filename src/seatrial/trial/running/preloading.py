"""Modules imported before a process is copied, so that the copies share them."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Sequence

from ...errors import InputError
from ...fmi.components.source import ComponentSource, find_source
from ...kits import is_ours
from ...system.system import Engine
from ..files.trial import Trial
from ..records.program import program

_OF_FMUS = ("seatrial.fmi.building.export", "seatrial.fmi.loading.load")


def preload(trials: Sequence[Trial], engine: Engine) -> None:
    """Import what the components of some trials need; of seatrial's own modules alone.

    What others wrote is imported where it can do no harm, in the copy. The program's identity is
    hashed once for all copies, too.
    """
    modules = set(() if engine == "direct" else _OF_FMUS)
    for trial in trials:
        for placed in (p for p in trial.rig.components.values() if p.entry.fmu):
            with contextlib.suppress(InputError):  # it will be said when it is loaded
                source = find_source(placed.entry.fmu, placed.scope.folder)
                if isinstance(source, ComponentSource) and is_ours(source.module):
                    modules.add(source.module)
    for module in sorted(modules):
        importlib.import_module(module)
    program()
