"""Systems of rigs as callers set them: assembled, started, and started anew."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, SimulationError
from .written import as_duration, as_engine, as_settings

if TYPE_CHECKING:
    from ..sim.master import Master
    from ..system.rig import Rig
    from ..system.system import System
    from ..system.values import Given


def assembled(
    rig: str | Path,
    settings: Mapping[str, Any] | None = None,
    *,
    seed: int = 1,
    variant: str | None = None,
    engine: str = "direct",
    step: float | str | None = None,
    choices: Mapping[str, str] | None = None,
) -> System:
    """Return the system of a rig with its parameters, as `Simulation` takes them, not started.

    Raises InputError for bad input.
    """
    from ..system.assembly import assemble
    from ..system.isolation import KEY_END, isolated_in, isolating

    given = as_settings(settings)
    loaded = _loaded_rig(str(rig), as_duration(step), choices)
    system = assemble(
        isolating(loaded, isolated_in(given, "set"), "set"),
        as_engine(engine),
        variant=variant,
        seed=int(seed),
    )
    try:
        for key, written in given.items():
            if not key.endswith(KEY_END):
                system.set(key, written, "set")
    except BaseException:
        system.discard()
        raise
    return system


def _loaded_rig(name: str, step: Any, choices: Mapping[str, str] | None) -> Rig:
    from ..shipped import available
    from ..system.flattening import load_rig
    from ..system.packages import is_package, read_package

    if is_package(name):
        if choices:
            raise InputError(f"{name}: a package has no choices, found {', '.join(choices)}")
        rig = read_package(Path(name).resolve(), {"step": step}).rig
    else:
        try:
            rig = load_rig(name, None, choices)
        except InputError as error:
            if name in available("harness/trials"):
                raise InputError(f"{name!r} is a trial: run_trial runs it; {error}") from None
            raise
    return rig if step is None else rig.changed({"step": step})


def give(system: System, settings: Mapping[str, Any], seed: int | None) -> None:
    """Give a system further settings, and another seed. Raises InputError."""
    from ..system.component_parameters import give_seed

    if seed is not None:
        system.seed = int(seed)
        for part in system.parts.values():
            give_seed(part, system.seed)
    for key, written in settings.items():
        system.set(key, written, "reset")


def cannot_start_anew(system: System) -> list[str]:
    """Return the components that a reset cannot take back to before their start."""
    return [
        name for name, part in system.parts.items() if not (part.is_sum or part.instance.restarts)
    ]


@dataclass(frozen=True)
class Origin:
    """What a system starts with: its seed, and what was given to each component."""

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


def started(system: System) -> Master:
    """Return the master of an assembled system, of which C carries what its engine says."""
    from ..plugins import service

    if system.engine == "native":
        service("native.carry")(system, weather=True)
    return begun(system)


def meet_weather(system: System) -> None:
    """Let hulls in C meet waves, current and wind of their parameters. Raises InputError."""
    from ..plugins import service

    if system.engine == "native":
        service("native.meet_weather")(system)


def begun(system: System) -> Master:
    """Return the master of a system that stands before its start. Raises InputError."""
    from ..sim.master import Master

    meet_weather(system)
    master = Master(system)
    try:
        master.initialise()
        system.refuse_wall_clock()
    except SimulationError as error:
        raise InputError(f"{system.rig.read_from.path}: the rig cannot start: {error}") from None
    return master
