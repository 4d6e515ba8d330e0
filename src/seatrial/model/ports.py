"""Ports: the declaration of a component's signals and parameters."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from ..errors import InputError, unknown

Kind = Literal["parameter", "input", "output"]
Scalar = float | int | bool | str
Limit = float | tuple[float, ...] | None
Units = str | tuple[str, ...]
"""One unit for all elements of a port, or one per axis."""

ROLES = {
    "home": "latitude or longitude of the origin of {n}: that of the rig's profile or home",
    "seed": "seed of the component's noise: derived from the run's seed unless it is given",
    "run-folder": "folder of the run, for logs of its own: given once there is one",
    "address": "where programs outside connect to: shown when a run in real time begins",
    "exceeded": "steps in which more came from outside than one takes in: a note of the run",
    "link-lost": "whether a link is lost: a note of the run, its end if it may reach devices",
    "reconnections": "times that a lost link came back: in the note of the run",
    "sea": "one of the parameters of the waves: given by a trial's sea, if it has one",
    "current": "one of the parameters of the current: given by a trial's current",
    "wind": "one of the parameters of the wind: given by a trial's wind",
    "start-time": "UTC at the start of the run: given by a trial's utc, if it has one",
    "wall-clock": "whether it lives on the wall clock: refused but in real time at factor 1",
    "shape": "the shape of the vehicle's file, as JSON: given by the vehicle that it names",
    "fault": "what goes wrong with it, in words: written by a trial's faults",
    "file": "name of a file: relative to the file that gives it, or to where the run begins",
    "tunables": "parameters of others that a link sets: a table in its profile",
    "arrivals": "what outside commands: in real time read again before a step, while it changes",
    "verdicts": "how the criteria of the trial stand, as JSON: told while it runs",
    "order": "time and text of the last order from outside: named where a simulation fails",
    "command": "an order that something moves by: a run has a line for one that nothing feeds",
    "bytes": "bytes with their times, as text (`links.text`): a Binary in FMI 3.0",
    "can": "the same with operations of a CAN bus: a terminal of FMI-LS-BUS too in FMI 3.0",
    "tunable": "values of a link's tunables, in their order: connected to what they set",
}
"""Roles of ports, and their treatment by the program that runs a component."""

BYTES = ("bytes", "can")
"""Roles of texts that are bytes with their times."""

VIEWS = {
    "deck": ("attitude", "place", "size"),
    "estimate": ("place", "home", "error", "passed"),
    "field-of-view": ("attitude", "height", "angle", "reach", "seen"),
    "foreseen": ("attitude", "now", "place", "turn", "time", "aim"),
    "landing-point": ("place", "phase"),
    "line": ("north", "east", "down"),
    "state": ("attitude", "value", "first", "words"),
    "target": ("attitude", "place", "radius"),
    "waypoints": ("count", "place"),
    "wind": ("velocity",),
}
"""Kinds of views and the ports that each names.

``attitude`` is an input: whose attitude feeds it carries what is drawn. deck: parameters, a place
on a deck (x, y and z from the body origin, m), its length and breadth about the origin (x and y,
m). field-of-view: parameters of a camera that looks along the body's z, its height below the origin
(m), half of its angle (rad) and its reach (m), and an output, whether it sees what it looks for.
foreseen: outputs, where a pad is taken to be now, and where and how turned at a time (north, east
and down in {n}, m; Euler angles ZYX, rad; s), and the time of a touch-down that is decided (s); 0
while there is none. state: an output, a whole number from the number ``first`` on, and the
``words`` for each, with commas between, empty for nothing to say. target: parameters, the middle of
a circle on a deck (x, y and z, m) and its radius (m).

estimate: outputs, where an autopilot takes itself and its home to be (north, east and down in
{n}, m), all 0 while it says neither, how far off the former is (m), and how many waypoints are
passed. landing-point: parameters, the place on a deck (x forward, y to starboard of the body
origin, m) and the name of the manoeuvre. line: outputs with one axis per point, its coordinates in
{n}, m. waypoints: parameters, how many there are and the port of each, whose name ends in ``_1``
and so on (north and east in {n}, m). wind: an output, velocity of the air (north and east in {n},
m/s).
"""

FRAMES = {"n": "{n}, north-east-down", "b": "{b}, body axes"}
"""Frames that a port with axes may be in, and how they are called."""

_BY_AXES = {
    ("north", "east", "down"): "n",
    ("north", "east"): "n",
    ("u", "v", "w"): "b",
    ("p", "q", "r"): "b",
}
"""Axes whose names say the frame."""

_TYPES: tuple[type, ...] = (float, int, bool, str)


class Port:
    """A named, typed value of a component: a scalar, or a vector whose elements have axis names.

    As a class attribute it is a descriptor: reading gives a float, int, bool or str, or a list
    of them if the port has axes; assigning converts to the port's type and checks the length.

    Values are SI with angles in radians; ``unit`` is written as in FMI (``N.m``, ``kg.m2``,
    ``rad/s``, ``1`` for a number), one for all elements or a tuple with one per axis. It is empty
    where a parameter says what the values mean: then connections convert nothing. A ``role`` of
    `ROLES` says what whoever runs the component does with the port. A ``frame`` of `FRAMES` is
    that of its axes: a connection between two frames is refused. The axes north, east, down and
    u, v, w and p, q, r say it by their names.
    """

    kind: Kind

    def __init__(
        self,
        unit: Units,
        description: str,
        *,
        start: Any,
        axes: Sequence[str] | None = None,
        type: type = float,
        min: Limit = None,
        max: Limit = None,
        nominal: Limit = None,
        role: str = "",
        frame: str = "",
    ) -> None:
        if role and role not in ROLES:
            raise ValueError(f"role {role!r} is none of {', '.join(ROLES)}")
        if frame and (frame not in FRAMES or axes is None):
            raise ValueError(f"frame {frame!r} is none of {', '.join(FRAMES)}, of a port with axes")
        if type not in _TYPES:
            raise TypeError(f"a port's type is float, int, bool or str, not {type!r}")
        for axis in axes or ():
            if not axis.isidentifier():  # FMI's structured names allow nothing else
                raise ValueError(f"axis {axis!r} is not an identifier (a letter first)")
        if len(set(axes or ())) != len(axes or ()):
            raise ValueError(f"two axes of {tuple(axes or ())} have the same name")
        self.name = ""
        self.unit = unit
        self.description = description
        self.axes = tuple(axes) if axes is not None else None
        self.type = type
        self.size = 1 if self.axes is None else len(self.axes)
        self.start = self._spread(start)
        self.min, self.max, self.nominal = min, max, nominal
        self.role = role
        self.frame = frame or _BY_AXES.get(tuple(axes or ()), "")
        for each in (unit, min, max, nominal):
            if isinstance(each, tuple) and len(each) != self.size:
                raise ValueError(f"{each} needs one element for each of {self.size} values")
        self.offset = -1

    def _spread(self, value: Any) -> list[Any]:
        """Return ``value`` as a list of ``size`` scalars of the port's type."""
        if self.axes is None:
            return [self._scalar(value)]
        values = list(value) if _is_sequence(value) else [value] * self.size
        if len(values) != self.size:
            raise ValueError(
                f"port {self.name or self.description!r} has {self.size} axes "
                f"({', '.join(self.axes)}), got {len(values)} values"
            )
        own = self.type
        return [v if type(v) is own else self._scalar(v) for v in values]

    def _scalar(self, value: Any) -> Scalar:
        if self.type is str:
            if not isinstance(value, str):
                raise TypeError(f"port {self.name!r} holds text, got {value!r}")
            return value
        if isinstance(value, str):
            raise TypeError(f"port {self.name!r} holds a number, got {value!r}")
        if self.type is int and value != int(value):
            raise ValueError(f"port {self.name!r} holds a whole number, got {value!r}")
        return self.type(value)  # type: ignore[no-any-return]

    @property
    def scalar_names(self) -> list[str]:
        """Names of the port's scalars: ``force.x``, ``force.y``, ...; or just ``force``."""
        if self.axes is None:
            return [self.name]
        return [f"{self.name}.{axis}" for axis in self.axes]

    def unit_of(self, index: int) -> str:
        """Return the unit of one scalar."""
        return self.unit[index] if isinstance(self.unit, tuple) else self.unit

    def limit(self, which: Literal["min", "max", "nominal"], index: int) -> float | None:
        """Return one scalar's min, max or nominal, None where the port declares none."""
        value: Limit = getattr(self, which)
        return value[index] if isinstance(value, tuple) else value

    def placed(self, offset: int) -> Port:
        """Return a copy whose values start at ``offset`` in a component's list of values."""
        port = copy.copy(self)
        port.offset = offset
        return port

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Any, owner: type | None = None) -> Any:
        if component is None:
            return self
        if self.axes is None:
            return component.values[self.offset]
        # A tuple: assigning to an element of a copy would be lost without a word.
        return tuple(component.values[self.offset : self.offset + self.size])

    def __set__(self, component: Any, value: Any) -> None:
        if self.axes is None and type(value) is self.type:  # mostly there is nothing to convert
            component.values[self.offset] = value
            return
        component.values[self.offset : self.offset + self.size] = self._spread(value)


class Parameter(Port):
    """A value fixed before a run, or between steps if ``tunable``: a Real or a String.

    Numbers are Real whatever the start value's type, because some masters can set nothing
    else. Text may be limited to ``choices``, or by ``check``, which raises InputError.
    """

    kind: Kind = "parameter"

    def __init__(
        self,
        start: Any,
        unit: Units,
        description: str,
        *,
        axes: Sequence[str] | None = None,
        min: Limit = None,
        max: Limit = None,
        nominal: Limit = None,
        tunable: bool = False,
        choices: Sequence[str] | None = None,
        check: Callable[[str], object] | None = None,
        role: str = "",
    ) -> None:
        if isinstance(start, bool):
            raise TypeError("a parameter is a number or a text: give 0.0 or 1.0 for a flag")
        kind = str if isinstance(start, str) else float
        super().__init__(
            unit,
            description,
            start=start,
            axes=axes,
            type=kind,
            min=min,
            max=max,
            nominal=nominal,
            role=role,
        )
        self.tunable = tunable
        self.choices = tuple(choices) if choices is not None else None
        self.check = check

    def check_text(self, value: str) -> None:
        """Raise InputError, with what is allowed, for a text that is not."""
        if self.choices is not None and value not in self.choices:
            raise InputError(unknown(f"value of {self.name}", value, self.choices))
        if self.check is not None:
            self.check(value)


class Input(Port):
    """A value that arrives over at most one connection; ``start`` holds while nothing is connected.

    An ``optional`` input is normally not connected: a run does not mention it. ``choices`` are the
    texts that one of text knows; what else comes is the component's to refuse.
    """

    kind: Kind = "input"

    def __init__(
        self,
        unit: Units,
        description: str,
        *,
        optional: bool = False,
        choices: Sequence[str] = (),
        **options: Any,
    ) -> None:
        options.setdefault("start", "" if options.get("type") is str else 0)
        super().__init__(unit, description, **options)
        self.optional = optional
        self.choices = tuple(choices)
        self.term_of = ""
        """Name of the `terms.Terms` that it is one of."""


class Output(Port):
    """A value that a component publishes, valid at the time it was computed for."""

    kind: Kind = "output"

    def __init__(self, unit: Units, description: str, **options: Any) -> None:
        options.setdefault("start", "" if options.get("type") is str else 0)
        super().__init__(unit, description, **options)


@dataclass(frozen=True)
class ScalarPort:
    """One scalar of a port: what FMI calls a scalar variable."""

    name: str
    reference: int
    port: Port
    index: int

    @property
    def unit(self) -> str:
        """Unit of this scalar."""
        return self.port.unit_of(self.index)


def lay_out(ports: dict[str, Port]) -> tuple[dict[str, Port], tuple[ScalarPort, ...]]:
    """Place ports in one flat list: parameters, then inputs, then outputs, as declared.

    Returns the placed ports by name and every scalar; a scalar's ``reference`` is its place.
    """
    placed: dict[str, Port] = {}
    scalars: list[ScalarPort] = []
    for kind in ("parameter", "input", "output"):
        for name, port in ports.items():
            if port.kind == kind:
                placed[name] = port.placed(len(scalars))
                for index, scalar in enumerate(port.scalar_names):
                    scalars.append(ScalarPort(scalar, len(scalars), placed[name], index))
    return placed, tuple(scalars)


def _is_sequence(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, str)
