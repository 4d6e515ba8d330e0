"""Systems of rigs and trials as callers set them: assembled, started, and started anew."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, SimulationError
from .written import as_duration, as_engine, as_settings

if TYPE_CHECKING:
    from ..sim.fault_schedule import Fault
    from ..sim.master import Master
    from ..system.references.values import Given
    from ..system.rig import Rig
    from ..system.system import System
    from ..trial.files.trial import Event, Trial


@dataclass(frozen=True)
class Assembled:
    """A system that has its parameters and is not started, and what its trial does with it."""

    system: System
    trial: Trial | None = None
    events: tuple[Event, ...] = ()
    faults: tuple[Fault, ...] = ()
    """Entries of the trial, in the order of its file."""

    @property
    def weather_seeds(self) -> list[str]:
        """Names of the seeds of sea, current and wind that are the run's, as nobody gave them."""
        from ..trial.files.surroundings import GROUPS

        if self.trial is None:
            return []
        given = {setting.key for setting in self.trial.settings()}
        groups = {group: getattr(self.trial.file, group) for group in GROUPS}
        names = [
            (name, f"{group}_seed")
            for group, entry in groups.items()
            if entry is not None and entry.seed is None
            for name in self.system.parts
        ]
        return [
            f"{name}.{seed}"
            for name, seed in names
            if seed in self.system.parts[name].given and f"{name}.{seed}" not in given
        ]

    def named(self, key: str) -> list[str]:
        """Return the names that a key of settings means: ``sea.height`` is one of each plant.

        Raises InputError for a sea, current or wind that the trial has not.
        """
        from ..system.references.values import port_scalars
        from ..trial.files.surroundings import GROUPS

        group, _, name = key.partition(".")
        is_of_group = self.trial is not None and group in GROUPS
        if not is_of_group or group in self.system.parts:
            return [key]
        scalars = f"{group}_{name}"
        found = [
            f"{part.name}.{scalars}"
            for part in self.system.parts.values()
            if port_scalars(part.instance.variables, scalars)
        ]
        if getattr(self.trial and self.trial.file, group) is None or not found:
            raise InputError(f"{key}: the trial has none; give it when the system is made")
        return found


def assembled(
    name: str | Path | Trial,
    settings: Mapping[str, Any] | None = None,
    *,
    seed: int | None = None,
    variant: str | None = None,
    engine: str = "direct",
    step: float | str | None = None,
    choices: Mapping[str, str] | None = None,
) -> Assembled:
    """Return the system of a rig or a trial with its parameters, as `Simulation` takes them.

    A trial may have been read.
    ``settings`` are those of the file ``name``: of a trial keys such as ``sea.height``, too.
    Raises InputError for bad input.
    """
    from ..trial.files.trial import Trial, load_trial

    given = as_settings(settings)
    if isinstance(name, Trial) or _is_trial(str(name)):
        changes = {f"choices.{key}": value for key, value in (choices or {}).items()}
        more = {"step": as_duration(step), "variant": variant, "seed": seed}
        changes |= {key: value for key, value in more.items() if value is not None}
        changes = {**given, **changes}
        if isinstance(name, Trial):
            return _of_trial(name.changed(changes, "set") if changes else name, engine)
        return _of_trial(load_trial(str(name), changes=changes, origin="set"), engine)
    from ..system.assembling.assembly import assemble
    from ..system.isolation import KEY_END, isolated_in, isolating

    loaded = _loaded_rig(str(name), as_duration(step), choices)
    system = assemble(
        isolating(loaded, isolated_in(given, "set"), "set"),
        as_engine(engine),
        variant=variant,
        seed=1 if seed is None else int(seed),
    )
    try:
        for key, written in given.items():
            if not key.endswith(KEY_END):
                system.set(key, written, "set")
    except BaseException:
        system.discard()
        raise
    return Assembled(system)


def _is_trial(name: str) -> bool:
    """Say if a name is that of a trial; where a rig has it too, it is the rig's."""
    from ..shipped import available
    from ..system.packages import is_package
    from ..trial.files.trial import is_trial

    if is_package(name):
        return False
    if name.endswith(".toml"):
        return is_trial(name)
    return name in available("harness/trials") and name not in available("harness/rigs")


def _of_trial(trial: Trial, engine: str) -> Assembled:
    from ..system.assembling.assembly import assemble
    from ..trial.running.checks import check_events, trial_faults

    if trial.start_ns:
        raise InputError(
            f"{trial.read_from.path}: start: {trial.file.start!r}; a simulation that a program "
            "steps starts at 0 s"
        )
    file = trial.file
    system = assemble(trial.rig, as_engine(engine), variant=file.variant, seed=file.seed)
    try:
        trial = trial.dated(system)
        trial.surround(system)
        for setting in trial.settings():
            system.set(*setting)
        trial = trial.scheduled(system)
        check_events(trial, system)
        return Assembled(system, trial, tuple(trial.events()), tuple(trial_faults(trial, system)))
    except BaseException:
        system.discard()
        raise


def _loaded_rig(name: str, step: Any, choices: Mapping[str, str] | None) -> Rig:
    from ..system.flattening import load_rig
    from ..system.packages import is_package, read_package

    if is_package(name):
        if choices:
            raise InputError(f"{name}: a package has no choices, found {', '.join(choices)}")
        rig = read_package(Path(name).resolve(), {"step": step}).rig
    else:
        rig = load_rig(name, None, choices)
    return rig if step is None else rig.changed({"step": step})


def give(made: Assembled, settings: Mapping[str, Any], seed: int | None) -> None:
    """Give a system further settings, and another seed. Raises InputError."""
    from ..system.assembling.component_parameters import give_seed

    system = made.system
    if seed is not None:
        system.seed = int(seed)
        for key in made.weather_seeds:
            system.set(key, float(seed), "seed")
        for part in system.parts.values():
            give_seed(part, system.seed)
    for key, written in settings.items():
        for name in made.named(key):
            system.set(name, written, "reset")


def cannot_start_anew(system: System) -> list[str]:
    """Return the components that a reset cannot take back to before their start."""
    return [
        name for name, part in system.parts.items() if not (part.is_sum or part.instance.restarts)
    ]


@dataclass(frozen=True)
class Origin:
    """Start of a system: its seed, and the values given to each component."""

    seed: int
    given: Mapping[str, Mapping[str, Given]]

    @classmethod
    def of(cls, system: System) -> Origin:
        """Return what a system starts with now."""
        return cls(system.seed, {name: dict(part.given) for name, part in system.parts.items()})

    def give_back(self, system: System) -> None:
        """Let a system start with this again."""
        system.seed = self.seed
        for name, given in self.given.items():
            system.parts[name].given = dict(given)


def started(made: Assembled) -> Master:
    """Return the master of an assembled system, of which C carries what its engine says."""
    from ..plugins import service

    if made.system.engine == "native":
        service("native.carry")(made.system, weather=True)
    return begun(made)


def meet_weather(system: System) -> None:
    """Let hulls in C meet waves, current and wind of their parameters. Raises InputError."""
    from ..plugins import service

    if system.engine == "native":
        service("native.meet_weather")(system)


def begun(made: Assembled) -> Master:
    """Return the master of a system that stands before its start. Raises InputError."""
    from ..sim.master import Master

    system = made.system
    meet_weather(system)
    master = Master(system)
    for fault in made.faults:
        master.faults.add(fault)
    try:
        master.initialise()
        system.refuse_wall_clock()
    except SimulationError as error:
        raise InputError(f"{system.rig.read_from.path}: the rig cannot start: {error}") from None
    act_on(made, master)
    return master


def act_on(made: Assembled, master: Master) -> None:
    """Let the events of the master's time happen. Raises SimulationError."""
    from ..sim.actions import action

    for event in made.events:
        if event.at_ns == master.time_ns:
            where = f"event {event.key}"
            action(made.system, "set", event.key, event.written, where).apply(master)


def steps_ahead(made: Assembled, master: Master, most: int) -> int:
    """Return how many communication steps there are to the next event, ``most`` at most."""
    ahead = [e.at_ns - master.time_ns for e in made.events if e.at_ns > master.time_ns]
    return min([most, *(-(-ns // master.step_ns) for ns in ahead)])
