"""Sequences of orders, manoeuvre by manoeuvre: helm and speed, and until when each holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

TURNED, SETTLED, SLOW, DEEP, LASTED = "turned", "settled", "slow", "deep", "lasted"
"""Ends of an order: a change of heading or pitch is reached, rate and speed are steady, the speed
ahead is down to a share of that of the approach, the depth is steady, five minutes are over."""
HELM, HEADING, RATE, PLANES = "helm", "heading", "rate", "planes"
"""What an order's share is of: the helm of the manoeuvre; nothing, the pilot holds the heading; the
rate of turn at the end of the first order, for which the helm is found; the manual dive."""


class Order(NamedTuple):
    """Helm and speed, and what ends them."""

    share: float
    """Of what ``by`` says, to the side of the manoeuvre."""
    until: str
    speed: float | None = None
    """Share of full speed, None for that of the approach."""
    angle: float = 0.0
    """Change of heading, or of pitch down, that ends it, rad, to the side of the manoeuvre: reached
    from below where it is to the side of the helm, from above where it is not."""
    by: str = HELM


@dataclass(frozen=True)
class Numbers:
    """Parameters of manoeuvres: angles in rad, above 0."""

    heading: float
    """Change that ends a leg of a zig-zag, of initial turning, the first of a Williamson turn."""
    turn: float
    """Heading change over which a turn is held."""
    steps: int
    """Steps of a spiral from helm amidships to full."""
    slow: float
    """Share of the approach speed at which a vessel that stops by inertia has done so."""
    speed: float
    """Speed order of the approach."""


_BEYOND = math.radians(10.0)
"""How far a manoeuvre goes on after its last figure, so that the record holds it."""
EXECUTES = 5
"""Executes of a zig-zag, by the IMO."""
POWERS = (1.0, 0.75, 0.5, 0.25)
"""Speed orders of a speed trial, shares of that of the approach: a double run with each."""
LASTING = 300.0
"""Time over which an order lasts that nothing else ends, s."""


def _turning_circle(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.turn)]


def _zig_zag(numbers: Numbers, by: str = HELM) -> list[Order]:
    sides = [(-1.0) ** number for number in range(EXECUTES)]
    return [Order(side, TURNED, angle=side * numbers.heading, by=by) for side in sides]


def _initial_turning(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.heading + _BEYOND)]


def _pull_out(numbers: Numbers) -> list[Order]:
    return [Order(1.0, TURNED, angle=numbers.turn), Order(0.0, SETTLED)]


def _spiral(numbers: Numbers) -> list[Order]:
    down = [1.0 - step / numbers.steps for step in range(2 * numbers.steps + 1)]
    return [Order(helm, SETTLED) for helm in (*down, *down[-2::-1])]


def _reverse_spiral(numbers: Numbers) -> list[Order]:
    rates = [1.0 - step / numbers.steps for step in range(1, 2 * numbers.steps)]
    return [Order(1.0, SETTLED), *(Order(rate, SETTLED, by=RATE) for rate in rates)]


def _speed_trial(numbers: Numbers) -> list[Order]:
    orders = []
    for number, share in enumerate(POWERS):
        speed, there = numbers.speed * share, (2 * number + 1) * math.pi
        run = Order(0.0, SETTLED, speed, by=HEADING)
        orders += [run, Order(1.0, TURNED, speed, there), run]
        orders.append(Order(1.0, TURNED, speed, there + math.pi))
    return orders[:-1]


def _williamson(numbers: Numbers) -> list[Order]:
    return [
        Order(1.0, TURNED, angle=numbers.heading),
        Order(-1.0, TURNED, angle=-math.pi - _BEYOND),
    ]


KINDS: Mapping[str, Callable[[Numbers], list[Order]]] = {
    "turning-circle": _turning_circle,
    "zig-zag": _zig_zag,
    "initial-turning": _initial_turning,
    "pull-out": _pull_out,
    "spiral": _spiral,
    "reverse-spiral": _reverse_spiral,
    "crash-stop": lambda _: [Order(0.0, SLOW, -1.0)],
    "stopping": lambda _: [Order(0.0, SLOW, 0.0)],
    "acceleration": lambda _: [Order(0.0, SETTLED, 1.0, by=HEADING)],
    "speed-trial": _speed_trial,
    "williamson": _williamson,
    "turn-on-the-spot": lambda numbers: [Order(1.0, TURNED, angle=numbers.turn)],
    "bollard-pull": lambda _: [Order(0.0, SETTLED, 1.0)],
    "station-keeping": lambda _: [Order(0.0, LASTED, 0.0)],
    "depth-step": lambda _: [Order(0.0, DEEP)],
    "vertical-zig-zag": lambda numbers: _zig_zag(numbers, PLANES),
}
"""Manoeuvres, and their orders."""
AT_REST = ("acceleration", "turn-on-the-spot", "bollard-pull", "station-keeping")
"""Manoeuvres that begin without speed."""
MODES = {"depth-step": "guided", "station-keeping": "hold", "bollard-pull": "manual"}
"""Modes of the pilot in manoeuvres that have one from the beginning to the end."""

STEERS, STOPS, STAYS = "steers", "stops", "stays"
DIVES, PITCHES, MOORED = "dives", "pitches", "moored"
"""Abilities: helm is ordered under way; the speed is ordered; the craft stays where it is and turns
there; the depth is held, and by the pitch; a line can hold it."""
NEEDS: Mapping[str, str] = {
    "crash-stop": STOPS,
    "stopping": STOPS,
    "acceleration": STOPS,
    "speed-trial": STOPS,
    "turn-on-the-spot": STAYS,
    "bollard-pull": MOORED,
    "station-keeping": STAYS,
    "depth-step": DIVES,
    "vertical-zig-zag": PITCHES,
}
"""What a vehicle must be able to do for a manoeuvre; `STEERS` for all others."""


def is_turned(order: Order, turned: float) -> bool:
    """Return whether the change of heading or pitch that ends an order is reached.

    ``turned`` is the change to the side of the manoeuvre, rad.
    """
    return turned >= order.angle if order.share > 0.0 else turned <= order.angle
