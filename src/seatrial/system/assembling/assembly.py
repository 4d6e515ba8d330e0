"""From a rig to the system that the master steps: load, give parameters, connect."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ...errors import InputError, unknown
from ...files.vehicle_folders import FOLDERS
from ...shipped import is_provided
from ..connecting import connect
from ..loading import load_part
from ..parameters import Outline
from ..part import Part
from ..profile.profile import Profiles
from ..rig import Rig
from ..system import Connection, Engine, System
from .bonds import bonds_of
from .component_parameters import followed, give_parameters, vehicles_of
from .fitted_parts import require_thrusts
from .shape_ports import resolve_shapes
from .tuning import connect_tunables


def assemble(
    rig: Rig,
    engine: Engine = "fmu",
    *,
    variant: str | None = None,
    seed: int = 1,
    progress: Callable[[str], None] = lambda _: None,
) -> System:
    """Load, or build, every FMU of ``rig``, and check its connections.

    ``variant`` replaces the rig's; ``seed`` is what the components' own seeds derive from,
    where a component has one. Raises InputError for anything in the files that does not fit.
    """
    system = System(rig, engine, seed, variant or rig.file.variant)
    profiles: dict[str, Profiles] = {}
    try:
        for name, placed in rig.components.items():
            progress(f"{name} ({placed.entry.what})")
            system.parts[name] = load_part(rig, name, engine)
            scope = placed.scope
            if scope.path not in profiles:
                profiles[scope.path] = Profiles(scope.file.profile, scope.read_from.path.parent)
            give_parameters(system, system.parts[name], profiles[scope.path])
        for scope, setting in rig.settings:
            written = followed(system, scope, setting.written, f"{setting.origin}: {setting.key}")
            system.set(*setting._replace(written=written))
        _refuse_idle_variant(system)
        require_thrusts(system)
        connect(system)
        system.bonds = bonds_of(system)
        for name, placed in rig.components.items():
            connect_tunables(system, system.parts[name], profiles[placed.scope.path])
        _yield_to_connections(system)
        resolve_shapes(system)
    except BaseException:
        system.discard()
        raise
    system.notes += _undecided(system)
    system.notes += _in_several_folders(rig) + far_off(system) + unasked(system)
    return system


def _in_several_folders(rig: Rig) -> list[str]:
    """Return notes on a user's vehicles whose rigs have files of their own."""
    names: dict[str, None] = {}
    for scope in rig.top.all():
        path = scope.read_from.path
        is_of_vehicle = path.parent.name in ("vehicles", "pilots")
        if is_of_vehicle and path.parent.parent.name == "rigs" and not is_provided(path):
            names.setdefault(path.stem)
    return [
        f"{name}: its files can be in one folder, {FOLDERS}/{name}: seatrial move-vehicle {name}"
        for name in names
    ]


def _undecided(system: System) -> list[str]:
    """Return notes on components whose outputs are taken to follow from all of their inputs."""
    of_why: dict[str, list[str]] = {}
    for part in system.parts.values():
        if part.undecided:
            of_why.setdefault(part.undecided, []).append(part.name)
    return [
        f"{', '.join(names)}: every output is taken to depend on every input at the same instant, "
        f"because the code does not tell ({why}); a declared feedthrough may say less"
        for why, names in of_why.items()
    ]


def _refuse_idle_variant(system: System) -> None:
    """Raise InputError for a variant that none of the vehicles in the rig has."""
    if not system.variant:
        return
    vehicles = [v for placed in system.rig.components.values() for v in vehicles_of(placed)]
    where = f"{system.rig.read_from.path}: variant {system.variant!r}"
    if not vehicles:
        raise InputError(
            f"{where}: no component takes parameters of a vehicle, so there is nothing to vary"
        )
    known = {variant for vehicle in vehicles for variant in vehicle.file.variants}
    if system.variant not in known:
        raise InputError(f"{where}: {unknown('variant', system.variant, known)}")


def _yield_to_connections(system: System) -> None:
    """Drop what a vehicle's file gives to connected ports; refuse what this rig gives to them.

    The vehicle's file speaks of all its rigs. What tunables set is where these start: it stays.
    """
    made = (*system.connections, *system.initial)
    fed = {connection.target for connection in made} - system.tuned
    for name, part in system.parts.items():
        for variable in [v for v in part.given if part.given[v].mark and (name, v) in fed]:
            del part.given[variable]
        for variable in part.given:
            system.refuse_connected(name, variable, part.given[variable].origin)


_PLACES = ("antenna", "place")
"""Parameters of sensors: from the body origin, body axes, m."""


def far_off(system: System) -> list[str]:
    """Return notes on sensors further from the hull beside them than its length.

    The hull is the outline about the body origin. A sensor may stand that far above or below it.
    """
    outlines = {_scope(n): part.outline for n, part in system.parts.items() if part.outline}
    notes = []
    for name, part in system.parts.items():
        outline = outlines.get(_scope(name))
        if outline is None or part.outline is not None:
            continue
        for port, place in _places(part):
            if _distance(place, outline) > outline.length:
                x, y, z = place
                notes.append(
                    f"{part.given[f'{port}.x'].origin}: {port} is at ({x:g}, {y:g}, {z:g}) m, "
                    f"outside of the hull of {outline.length:g} m by {outline.beam:g} m by more "
                    "than its length"
                )
    return notes


def _places(part: Part) -> Iterator[tuple[str, tuple[float, float, float]]]:
    for port in _PLACES:
        given = [part.given.get(f"{port}.{axis}") for axis in "xyz"]
        if all(given):
            x, y, z = (float(one.value) for one in given if one is not None)
            yield port, (x, y, z)


def _distance(place: tuple[float, float, float], outline: Outline) -> float:
    """Return how far a place is outside of the outline, along the axis where it is most."""
    x, y, z = place
    return max(abs(x) - outline.length / 2.0, abs(y) - outline.beam / 2.0, abs(z))


def _scope(name: str) -> str:
    return name.rpartition(".")[0]


_AXES = {
    "surge": "surge",
    "sway": "sway",
    "heave": "heave",
    "roll_moment": "roll",
    "pitch_moment": "pitch",
    "yaw_moment": "yaw",
}
"""Axes of an allocation by its inputs."""


def unasked(system: System) -> list[str]:
    """Return notes on demands that reach an allocation and are not among its ``axes``."""
    notes = []
    for connection in system.connections:
        name, port = connection.target
        part, axis = system.parts[name], _AXES.get(port, "")
        if not axis or "propulsor_order.p1" not in part.instance.variables:
            continue
        axes = str(_value(part, "axes", axis))
        if axis not in axes.split() and _asks(system, connection):
            origin = part.given["axes"].origin if "axes" in part.given else ""
            file = origin.removesuffix(f": {name}.axes")
            notes.append(
                f"{file}{': ' if file else ''}{name}.axes is {axes!r}: nothing gives {axis}, "
                f"which {'.'.join(connection.source)} asks for"
            )
    return notes


def _asks(system: System, connection: Connection) -> bool:
    """Return whether a demand may be other than 0: a helm has axes that it does not steer."""
    name, port = connection.source
    part = system.parts[name]
    if f"{port}_limit" not in part.instance.variables:
        return True
    held = (name, f"{port}_held")
    fed = any(one.target == held for one in system.connections)
    return fed or _value(part, f"{port}_limit", 0.0) != 0.0


def _value(part: Part, name: str, otherwise: object) -> object:
    if name in part.given:
        return part.given[name].value
    variable = part.instance.variables.get(name)
    return otherwise if variable is None else variable.start
