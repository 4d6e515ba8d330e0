"""A trial made ready: its rig assembled, everything set and checked, nothing written yet."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ...errors import InputError, SimulationError, listed
from ...plugins import service
from ...sim.master import Master
from ...system.assembly import assemble
from ...system.forgotten import forgotten
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
from .recording import Recorded, recorded_signals


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
