"""True directions of what compasses and receivers report: the choice of the magnetic variation."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

from seatrial.links.earth_field import earth_field

from .memory import Received

_DAY_S = 86400.0


class Variation(NamedTuple):
    """Magnetic variation, rad, positive east, and where it is from, for a reader."""

    value: float
    origin: str


class Direction(NamedTuple):
    """A true direction, rad, from 0 to below 2 pi, and where it is from."""

    value: float
    origin: str


def variation_of(
    received: Received, now_ns: int, own: Callable[[], Variation | None]
) -> Variation | None:
    """Return the variation received, or else the receiver's ``own``; None if there is none."""
    values = received.valid("variation", now_ns)
    if values is None:
        return own()
    source, kind = received.origin("variation")
    return Variation(values[0], f"variation of {kind} from {source}")


def true_direction(
    received: Received, name: str, now_ns: int, variation: Variation | None
) -> Direction | None:
    """Return a true direction of a quantity; None if none is valid.

    true = magnetic + variation. Of a true and a magnetic one the source with the higher priority
    counts, of two sources without any the true one, of one source the newest. A magnetic one with
    a variation in its own message has that.
    """
    true = received.valid(name, now_ns)
    reported = received.valid(f"magnetic_{name}", now_ns)
    if true is not None and (reported is None or _first(received, name)):
        source, kind = received.origin(name)
        return Direction(true[0] % math.tau, f"{kind} from {source}")
    if reported is None:
        return None
    source, kind = received.origin(f"magnetic_{name}")
    if len(reported) > 1:
        variation = Variation(reported[1], "its own variation")
    if variation is None:
        return None
    value = (reported[0] + variation.value) % math.tau
    return Direction(value, f"magnetic {kind} from {source}, {variation.origin}")


def _first(received: Received, name: str) -> bool:
    """Return whether the true one of two valid directions counts before the magnetic one."""
    magnetic = f"magnetic_{name}"
    if received.origin(name) == received.origin(magnetic):
        return received.since(name) >= received.since(magnetic)
    return received.rank(name) <= received.rank(magnetic)


def magnetic_direction(
    received: Received, name: str, now_ns: int, variation: Variation | None
) -> float | None:
    """Return a magnetic direction of a quantity, received or true - variation; None if none."""
    reported = received.valid(f"magnetic_{name}", now_ns)
    if reported is not None:
        return reported[0] % math.tau
    true = received.valid(name, now_ns)
    return None if true is None or variation is None else (true[0] - variation.value) % math.tau


def modelled(latitude: float, longitude: float, day: float, place: str) -> Variation:
    """Return the variation of the World Magnetic Model.

    ``latitude`` and ``longitude`` in degrees, ``day`` in days since 1970, ``place`` its name.
    """
    value = _modelled(round(latitude, 2), round(longitude, 2), math.floor(day))
    return Variation(value, f"World Magnetic Model at {place}")


@lru_cache(64)
def _modelled(latitude: float, longitude: float, day: int) -> float:
    here = math.radians(latitude), math.radians(longitude)
    north, east, _ = earth_field(*here, 0.0, day * _DAY_S)
    return math.atan2(east, north)
