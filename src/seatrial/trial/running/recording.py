"""The signals that a trial records: those it asks for, or all of components that are no giants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...sim.recorder import matching, output_names
from ...system.system import System
from ..files.trial import Trial

MOST_UNASKED = 1000
"""Outputs of one component that are recorded if the trial does not say which."""


@dataclass(frozen=True)
class Recorded:
    """Names of signals, ``component.port``, in the order of their declaration."""

    signals: Sequence[str]
    notes: list[str] = field(default_factory=list)
    """On components of which a part is recorded."""


def recorded_signals(trial: Trial, system: System, *, is_asked: bool) -> Recorded:
    """Return what is recorded; ``is_asked`` if the trial's author wrote ``record.signals``.

    Otherwise all outputs, but of a component with very many those that connections, criteria,
    plots or the pace read, and the first others, up to `MOST_UNASKED`. Raises InputError for a
    pattern that matches nothing.
    """
    names = output_names(system)
    if is_asked:
        return Recorded(matching(names, trial.file.record.signals))
    read = _read(trial, system)
    signals, notes = [], []
    for component, part in system.parts.items():
        variables = part.instance.variables.values()
        own = [f"{component}.{v.name}" for v in variables if v.causality == "output"]
        kept = own
        if len(own) > MOST_UNASKED:
            others = MOST_UNASKED - sum(name in read for name in own)
            unread = set([name for name in own if name not in read][: max(others, 0)])
            kept = [name for name in own if name in read or name in unread]
            notes.append(
                f"{len(kept)} of {len(own)} outputs of {component} are recorded, what something "
                f'reads and the first: signals = ["{component}.*"] in [record] takes all'
            )
        signals += kept
    return Recorded(signals, notes)


def _read(trial: Trial, system: System) -> set[str]:
    """Return the outputs that a connection, a criterion, a plot or the pace reads."""
    read = {".".join(connection.source) for connection in system.connections}
    read.update(name for _, criterion in trial.criteria for name in criterion.signals)
    read.update(name for plot in trial.file.plots for name in plot.signals)
    pace = trial.file.real_time
    if pace is not None:
        read.update(name for name in (pace.factor, pace.paused) if isinstance(name, str))
    return read
