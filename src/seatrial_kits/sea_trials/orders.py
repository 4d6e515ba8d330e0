"""Sequences of orders, manoeuvre by manoeuvre: helm and speed, and until when each holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

TURNED, SETTLED, SLOW, DEEP = "turned", "settled", "slow", "deep"
"""Ends of an order: a heading change is reached, rate and speed are steady, the speed ahead is
down to a share of that of the approach, the depth is steady."""


class Order(NamedTuple):
    """Helm and speed, and what ends them."""

    helm: float
    """Share of the helm of the manoeuvre, to its side."""
    until: str
    speed: float | None = None
    """Share of full speed, None for that of the approach."""
    angle: float = 0.0
    """Heading change that ends it, rad, to the side of the manoeuvre: reached from below where it
    is to the side of the helm, from above where it is not."""


@dataclass(frozen=True)
class Numbers:
    """Parameters of manoeuvres: angles in rad, above 0."""

    heading: float
    """Heading change of a zig-zag, of initial turning, of the first leg of a Williamson turn."""
    turn: float
    """Heading change over which a turn is held."""
    steps: int
    """Steps of a spiral from helm amidships to full."""
    slow: float
    """Share of the approach speed at which a vessel that stops by inertia has done so."""


_BEYOND = math.radians(10.0)
"""How far a manoeuvre goes on after its last figure, so that the record holds it."""
EXECUTES = 5
"""Executes of a zig-zag, by the IMO."""


def _turning_circle(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.turn)]


def _zig_zag(numbers: Numbers) -> list[Order]:
    sides = [(-1.0) ** number for number in range(EXECUTES)]
    return [Order(side, TURNED, angle=side * numbers.heading) for side in sides]


def _initial_turning(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.heading + _BEYOND)]


def _pull_out(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.turn), Order(0.0, SETTLED)]


def _spiral(numbers: Numbers) -> list[Order]:
    down = [1.0 - step / numbers.steps for step in range(2 * numbers.steps + 1)]
    return [Order(helm, SETTLED) for helm in (*down, *down[-2::-1])]


def _crash_stop(numbers: Numbers) -> list[Order]:
    return [Order(0.0, SLOW, -1.0)]


def _stopping(numbers: Numbers) -> list[Order]:
    return [Order(0.0, SLOW, 0.0)]


def _acceleration(numbers: Numbers) -> list[Order]:
    return [Order(0.0, SETTLED, 1.0)]


def _williamson(numbers: Numbers) -> list[Order]:
    return [
        Order(1.0, TURNED, angle=numbers.heading),
        Order(-1.0, TURNED, angle=-math.pi - _BEYOND),
    ]


def _turn_on_the_spot(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.turn)]


def _depth_step(numbers: Numbers) -> list[Order]:
    return [Order(0.0, DEEP)]


KINDS: Mapping[str, Callable[[Numbers], list[Order]]] = {
    "turning-circle": _turning_circle,
    "zig-zag": _zig_zag,
    "initial-turning": _initial_turning,
    "pull-out": _pull_out,
    "spiral": _spiral,
    "crash-stop": _crash_stop,
    "stopping": _stopping,
    "acceleration": _acceleration,
    "williamson": _williamson,
    "turn-on-the-spot": _turn_on_the_spot,
    "depth-step": _depth_step,
}
"""Manoeuvres, and their orders."""
AT_REST = ("acceleration", "turn-on-the-spot")
"""Manoeuvres that begin without speed."""


def is_turned(order: Order, turned: float) -> bool:
    """Return whether the heading change that ends an order is reached.

    ``turned`` is the heading change to the side of the manoeuvre, rad.
    """
    return turned >= order.angle if order.helm > 0.0 else turned <= order.angle
