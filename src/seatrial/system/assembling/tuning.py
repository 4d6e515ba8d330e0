"""Tunables of links in a rig: connected to what they set, starting at the values that it has."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...errors import InputError
from ...model.units import conversion
from ..part import Part
from ..profile.profile import Profiles
from ..references.values import Given
from ..rig import Placed
from ..system import Connection, Joint, System
from ..tunables import Tunable, carried

_PILOT = "pilot"
"""Name of the rig beside a link whose parameters its profile's table means."""


@dataclass(frozen=True)
class Tuning:
    """The tunables of one link, with the parameters that each sets: component and variable."""

    link: str
    text: str
    """Parameter of the link that says names, starts and limits."""
    tunables: tuple[Tunable, ...]
    targets: tuple[tuple[tuple[str, str], ...], ...]

    def update(self, system: System) -> None:
        """Let every tunable start at the value that its target has now. Raises InputError."""
        pairs = zip(self.tunables, self.targets, strict=True)
        starts = [self._start(system, tunable, targets) for tunable, targets in pairs]
        value = carried(self.tunables, starts)
        system.parts[self.link].given[self.text] = Given(value, "values of what its tunables set")

    def _start(
        self, system: System, tunable: Tunable, targets: tuple[tuple[str, str], ...]
    ) -> float:
        values = [_value(system, tunable, *target) for target in targets]
        low, high = min(values), max(values)
        names = " and ".join(".".join(target) for target in targets)
        if not math.isclose(low, high, rel_tol=1e-9):
            raise InputError(f"{self.link}: {tunable.name} sets {names}, which differ: {values}")
        if not tunable.min <= low <= tunable.max:
            raise InputError(
                f"{self.link}: {tunable.name} sets {names}, which is {low!r} {tunable.unit}; "
                f"its limits are {tunable.min!r} to {tunable.max!r}"
            )
        return values[0]


def connect_tunables(system: System, part: Part, profiles: Profiles) -> None:
    """Connect the tunables of a link's profile to the pilot beside it. Raises InputError.

    A limit beyond that of what it sets is refused: a value in between would end the run.
    Where the link stands beside no pilot and beside none of the components that they set, or
    the rig gives it tunables of its own, there are none.
    """
    placed, variables = system.rig.components[part.name], part.instance.variables
    texts = variables.of_role("tunables")
    if not texts or placed.entry.profile is None or texts[0] in placed.entry.set:
        return
    profile, section = profiles.find(placed.entry.profile, f"{placed.where}.profile")
    tunables = profile.tunables(section)
    base = _base(placed, tunables)
    if not tunables or base is None:
        if tunables:
            system.open.append(f"{part.name}: nothing beside it has what its tunables set")
        return
    where = f"{profile.read_from.path}: {section}.tunables"
    outputs = variables.of_role("tunable")
    targets = [
        tuple(_target(system, f"{base}{each}", f"{where}.{t.name}") for each in t.targets)
        for t in tunables
    ]
    for output, tunable, fed in zip(outputs, tunables, targets, strict=False):
        for component, name in fed:
            _feed(system, (part.name, output), (component, name), tunable, where)
    tuning = Tuning(part.name, texts[0], tunables, tuple(targets))
    tuning.update(system)
    system.tunings.append(tuning)


def _base(placed: Placed, tunables: tuple[Tunable, ...]) -> str | None:
    """Return the beginning of the paths that the tunables set, None if there is nothing."""
    scope = placed.scope
    at = f"{scope.path}." if scope.path else ""
    if _PILOT in scope.inner:
        return f"{at}{_PILOT}."
    heads = {target.partition(".")[0] for tunable in tunables for target in tunable.targets}
    return at if heads & scope.file.components.keys() else None


def _target(system: System, path: str, where: str) -> tuple[str, str]:
    """Return the one real tunable parameter that a path means. Raises InputError."""
    (part, port), *_others = system.located(path, f"{where}.sets")
    variable = part.instance.variables.get(port)
    if variable is None or variable.type is not float or variable.variability != "tunable":
        known = [
            name
            for name, v in part.instance.variables.items()
            if v.type is float and v.variability == "tunable"
        ]
        raise InputError(
            f"{where}.sets: {path} is no tunable parameter; of {part.name} these are: "
            f"{', '.join(known) or 'none'}"
        )
    return part.name, port


def _feed(
    system: System, source: tuple[str, str], target: tuple[str, str], tunable: Tunable, where: str
) -> None:
    variable = system.parts[target[0]].instance.variables[target[1]]
    for connection in system.connections:
        if connection.target == target:
            raise InputError(
                f"{where}.{tunable.name}: {'.'.join(target)} is already fed by "
                f"{'.'.join(connection.source)}"
            )
    try:
        factor, offset = conversion(tunable.unit or variable.measure, variable.measure)
    except InputError as error:
        raise InputError(f"{where}.{tunable.name}.unit: {error}") from None
    for limit, own, way in (
        (tunable.min, variable.minimum, -1),
        (tunable.max, variable.maximum, 1),
    ):
        beyond = 0.0 if own is None else way * (factor * limit + offset - own)
        if beyond > 1e-9 * abs(own or 1.0):  # what conversion leaves
            raise InputError(
                f"{where}.{tunable.name}: {limit!r} {tunable.unit or variable.unit} is beyond the "
                f"limit of {'.'.join(target)}, {own!r} {variable.unit}"
            )
    system.joints.append(Joint(".".join(source), ".".join(target), factor, offset))
    system.connections.append(Connection(source, target, factor, offset))


def _value(system: System, tunable: Tunable, component: str, name: str) -> float:
    """Return a parameter as given so far, in the tunable's unit."""
    part = system.parts[component]
    variable, given = part.instance.variables[name], part.given.get(name)
    value = variable.start if given is None else given.value
    assert isinstance(value, float)
    factor, offset = conversion(variable.measure, tunable.unit or variable.measure)
    if (factor, offset) == (1.0, 0.0):
        return value
    return float(f"{factor * value + offset:.12g}")  # 12 deg are 12 again
