"""Tunables of a link: parameters of other components that a ground station sets.

A profile has them in a table of the link, ``[links.NAME.tunables]``: by the name that the ground
station sees, what it ``sets``, ``min``, ``max`` and ``unit``. FMI has no tables: the link takes
them as the text of its parameter with the role ``tunables``, which `carried` writes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pydantic import Field

from ..errors import InputError
from ..model.ports import Parameter
from ..model.units import unit
from .files import FileModel

_PATH = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)+", re.ASCII)
_NAME = re.compile(r"[^\s;]+")
"""What is one word of the text, be it a name or not."""


class TunableEntry(FileModel):
    """One tunable as a profile writes it."""

    sets: str | list[str] = Field(
        title="`component.parameter`, or a list", description="the tunable parameters that it sets"
    )
    min: float = Field(title="number", description="least value, in the unit")
    max: float = Field(title="number", description="greatest value, in the unit")
    unit: str = Field(
        "", title="unit", description="unit that is seen outside; the parameter's if it is missing"
    )

    @property
    def targets(self) -> tuple[str, ...]:
        """What it sets, as a list."""
        return (self.sets,) if isinstance(self.sets, str) else tuple(self.sets)


@dataclass(frozen=True)
class Tunable:
    """One tunable of a link; its value is on the link's output of that role, in their order."""

    name: str
    targets: tuple[str, ...]
    """Paths of the tunable parameters that take its value, below the pilot beside the link."""
    min: float
    max: float
    unit: str
    """Unit of value, ``min`` and ``max``; empty: that of the targets."""


def read_tunables(table: Mapping[str, TunableEntry], port: Parameter) -> tuple[Tunable, ...]:
    """Return a table's tunables in their order; ``port`` is the parameter that carries them.

    Raises InputError with a line for each mistake: what the link refuses (names, limits, too
    many), units that there are not, and what is set twice or is no path.
    """
    tunables = tuple(Tunable(n, e.targets, e.min, e.max, e.unit) for n, e in table.items())
    mistakes: list[str] = []
    taken: dict[str, str] = {}
    for tunable in tunables:
        mistakes += _mistakes(tunable, port, taken)
    if not mistakes:
        port.check_text(carried(tunables, _middles(tunables)))
    if mistakes:
        raise InputError("\n".join(mistakes))
    return tunables


def carried(tunables: Sequence[Tunable], starts: Sequence[float]) -> str:
    """Return tunables as the link's parameter takes them: ``NAME START MIN MAX; ...``.

    ``starts`` has the first value of each, in its unit.
    """
    return "; ".join(
        f"{tunable.name} {start!r} {tunable.min!r} {tunable.max!r}"
        for tunable, start in zip(tunables, starts, strict=True)
    )


def _middles(tunables: Sequence[Tunable]) -> list[float]:
    """Return starts that are within the limits."""
    return [(tunable.min + tunable.max) / 2.0 for tunable in tunables]


def _mistakes(tunable: Tunable, port: Parameter, taken: dict[str, str]) -> list[str]:
    """Return what is wrong with one; ``taken`` has what is set so far, and by which."""
    name, mistakes = tunable.name, []
    if not _NAME.fullmatch(name):
        return [f"{name!r} cannot be a tunable's name"]
    try:
        port.check_text(carried([tunable], _middles([tunable])))
        if tunable.unit:
            unit(tunable.unit)
    except InputError as error:
        mistakes.append(f"{name}: {error}")
    if not tunable.targets:
        mistakes.append(f"{name}.sets: at least one parameter is needed")
    for target in tunable.targets:
        if not _PATH.fullmatch(target):
            mistakes.append(
                f"{name}.sets: something like 'guidance.cruise_speed' is needed, found {target!r}"
            )
        elif target in taken:
            mistakes.append(f"{name}.sets: {target!r} is already set by {taken[target]}")
        taken.setdefault(target, name)
    return mistakes
