"""Sentences about the leg that is followed, for autopilots and plotters; as `sentences`."""

from __future__ import annotations

from collections.abc import Callable

from .codec import KNOT, MILE, Fields, bearing, mode, number, status, time
from .readings import Readings

_MOST_RMB = 9.99
"""Largest cross-track error of RMB, miles."""


def _xte(of: Readings) -> Fields:
    valid = status(of.leg)
    error = None if of.leg is None else of.leg.cross_track
    return {
        "gwarn": valid,
        "LCcwarn": valid,
        "ctrkerr": number(None if error is None else abs(error), 3, MILE),
        "dirs": "" if error is None else "L" if error > 0.0 else "R",
        "disUnit": "N",
        "mode": mode(of.leg),
    }


def _rmb(of: Readings) -> list[Fields]:
    """Return none without a leg, as plotters do: some readers take empty fields for zeros."""
    leg, places = of.leg, of.waypoints
    if leg is None or places is None:
        return []
    fields = {
        "status": "A",
        "ctrkerr": number(min(abs(leg.cross_track) / MILE, _MOST_RMB), 2),
        "dirs": "L" if leg.cross_track > 0.0 else "R",
        "wptO": f"WP{leg.number - 1}",
        "wptD": f"WP{leg.number}",
        "lat": places[1][0],
        "lon": places[1][1],
        "range": number(min(leg.distance / MILE, 999.9), 2),
        "bearing": bearing(leg.bearing),
        "velclos": number(leg.closing, 2, KNOT),
        "arrstatus": "A" if leg.arrived else "V",
        "valstatus": "A",
    }
    return [fields]


def _apb(of: Readings) -> Fields:
    """Return the steering data; the heading to steer is the bearing of the waypoint."""
    leg = of.leg
    side = "" if leg is None else "L" if leg.cross_track > 0.0 else "R"
    return {
        "LCgwarn": status(leg),
        "LCcwarn": status(leg),
        "ctrkerr": number(None if leg is None else abs(leg.cross_track), 3, MILE),
        "dirs": side,
        "ctrkUnit": "N",
        "aalmcirc": "A" if leg is not None and leg.arrived else "V",
        "aalmperp": "A" if leg is not None and leg.passed else "V",
        "bearO2D": bearing(None if leg is None else leg.direction),
        "bearO2Du": "T",
        "wpt": "" if leg is None else f"WP{leg.number}",
        "bearD": bearing(None if leg is None else leg.bearing),
        "bearDu": "T",
        "bearS": bearing(None if leg is None else leg.bearing),
        "bearSu": "T",
        "mode": mode(leg),
    }


def _bwc(of: Readings) -> Fields:
    """Return distance and bearing of the waypoint."""
    leg, ends = of.leg, of.waypoints
    there = {"lat": "", "lon": ""} if ends is None else {"lat": ends[1][0], "lon": ends[1][1]}
    return {
        "fixutc": time(of),
        **there,
        "bearT": bearing(None if leg is None else leg.bearing),
        "bearTu": "T",
        "bearM": bearing(None if leg is None else of.magnetic(leg.bearing)),
        "bearMu": "M",
        "dist": number(None if leg is None else leg.distance, 3, MILE),
        "distUnit": "N",
        "wpt": "" if leg is None else f"WP{leg.number}",
        "mode": mode(leg),
    }


def _bod(of: Readings) -> Fields:
    """Return the bearing of the leg, from its origin to its destination."""
    leg = of.leg
    return {
        "bearT": bearing(None if leg is None else leg.direction),
        "bearTu": "T",
        "bearM": bearing(None if leg is None else of.magnetic(leg.direction)),
        "bearMu": "M",
        "wptD": "" if leg is None else f"WP{leg.number}",
        "wptO": "" if leg is None else f"WP{leg.number - 1}",
    }


ROUTE: dict[str, Callable[[Readings], Fields]] = {
    "XTE": _xte,
    "APB": _apb,
    "BWC": _bwc,
    "BOD": _bod,
}
"""Those that are always sent, by formatter."""

ROUTE_LEG: dict[str, Callable[[Readings], list[Fields]]] = {"RMB": _rmb}
"""Those that are not sent without a leg."""
