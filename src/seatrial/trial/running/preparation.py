"""A trial made ready: its rig assembled, everything set and checked, nothing written yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ...errors import InputError, SimulationError, listed
from ...plugins import service
from ...sim.master import Master
from ...sim.recorder import matching, output_names
from ...system.assembling.assembly import assemble
from ...system.assembling.fitted_parts import forgotten
from ...system.system import Engine, System
from ...system.unread import leave_out_unread
from ..files.naming import by_path, named_components
from ..files.trial import Trial
from ..records.manifest import manifest
from .checks import (
    check_criteria,
    check_events,
    check_figures,
    check_plots,
    check_real_time,
    trial_faults,
)
from .hooks import Hooks

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


@dataclass(frozen=True)
class Prepared:
    """A trial with its assembled rig."""

    trial: Trial
    engine: Engine
    system: System
    units: dict[str, str]
    """Of every output, ``component.port``."""
    recorded: Recorded

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """What decides the signals; see `manifest`."""
        return manifest(self.trial, self.system, self.engine)

    def started(self) -> Master:
        """Return a master with all components at the start time.

        Raises InputError for a rig that cannot start.
        """
        trial = self.trial
        master = Master(self.system, trial.start_ns, trial.stop_ns)
        for fault in trial_faults(trial, self.system):
            master.faults.add(fault)
        try:
            master.initialise()
        except SimulationError as error:
            path = trial.rig.read_from.path
            raise InputError(f"{path}: the rig cannot start: {error}") from None
        pace = trial.file.real_time
        if pace is None or pace.factor != 1.0:
            self.system.refuse_wall_clock()
        return master

    def loose_inputs(self) -> list[str]:
        """Return notes on the inputs that neither connection nor event reaches.

        Forces, moments and commands have a line each.
        """
        moved = {event.key for event in self.trial.events()}
        loose = [name for name in self.system.unconnected_inputs() if name not in moved]
        alone = forgotten(self.system, moved)
        others = [name for name in loose if name not in alone]
        said = f"inputs that nothing feeds keep their start values: {listed(others)}"
        return [*alone.values(), *([said] if others else [])]


def prepare(trial: Trial, engine: Engine, hooks: Hooks) -> Prepared:
    """Assemble the rig of a trial, set what the trial says, and check the rest against it.

    Raises InputError for anything that does not fit, StoppedError.
    """

    def building(what: str) -> None:
        hooks.refuse_if_stopped()
        hooks.building(what)

    system = assemble(
        trial.rig, engine, variant=trial.file.variant, seed=trial.file.seed, progress=building
    )
    try:
        trial = trial.dated(system)
        trial.surround(system)
        for setting in trial.settings():
            system.set(*setting)
        for key, factor, origin in trial.scales:
            system.scale(key, factor, origin)
        is_asked = "signals" in trial.file.record.model_fields_set
        trial = by_path(trial.scheduled(system), system)
        units = check_criteria(trial, system)
        check_plots(trial, system)
        check_figures(trial, system)
        check_events(trial, system)
        trial_faults(trial, system)
        check_real_time(trial, system)
        leave_out_unread(system, named_components(trial, system))
        if system.engine == "native":
            service("native.carry")(system, building)
        recorded = recorded_signals(trial, system, is_asked=is_asked)
    except BaseException:
        system.discard()
        raise
    return Prepared(trial, engine, system, units, recorded)
