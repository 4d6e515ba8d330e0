"""Figures of a manoeuvre by its kind, whatever the record comes from."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from seatrial.errors import InputError, unknown

from .figures.course_stability import loop, pull_out, spiral, stability
from .figures.criteria import SHIP, Verdict, imo
from .figures.handling import station_box, turn_on_the_spot, williamson
from .figures.nomoto import nomoto, nomoto_second
from .figures.record import Array, Record
from .figures.result import Figure, Figures
from .figures.straight import acceleration, bollard_pull, speed_trial, stopping
from .figures.turning import turning_circle
from .figures.vertical import depth_step, pitch_zig_zag
from .figures.zigzag import initial_turning, zig_zag


@dataclass(frozen=True)
class Done:
    """A manoeuvre that was done: its record, and what its figures need. SI, angles in rad."""

    kind: str
    record: Record
    orders: tuple[float, ...] = ()
    """Times of the orders, s; none: found from helm."""
    heading: float = math.radians(10.0)
    """Heading change of a zig-zag and of initial turning."""
    share: float = 0.2
    """Share of the approach speed at which a vessel that coasts has stopped."""
    depth: float | None = None
    """Depth that a step leads to, m."""
    length: float | None = None
    """Length of the ship, m."""
    beam: float | None = None
    """Beam of its outline, m."""
    helm: float | None = None
    """Helm that was ordered, where that is known."""
    full_helm: float = math.radians(35.0)
    """The most helm that there is."""
    window: float = 60.0
    """How long all is steady at the end of an order, s."""
    side: str = ""
    """Of the first order, where that is known."""
    criteria: str = "none"
    """imo; of ships of 100 m and more, length; none."""

    @property
    def first(self) -> float | None:
        """Time of the first order, s, if it is known."""
        return self.orders[0] if self.orders else None

    def needed(self, number: int = 0) -> float:
        """Return the time of an order; raises InputError if it is not known."""
        if number >= len(self.orders):
            raise InputError(f"{self.kind}: the time of the order is needed")
        return self.orders[number]


def figures_of(done: Done) -> Figures:
    """Return the figures of a manoeuvre; raises InputError as they do, and for an unknown kind."""
    if done.kind not in FIGURES:
        raise InputError(unknown("manoeuvre", done.kind, FIGURES))
    return FIGURES[done.kind](done)


def criteria_name(done: Done) -> str:
    """Return the name under which `imo` has the figures: that of the trial.

    It has those of turning circles at full helm, of initial turning and zig-zags with a helm equal
    to the heading change; where the helm is known to be another, the name says it.
    """
    angle = f"{math.degrees(done.heading):g}"
    usual = {"turning-circle": done.full_helm, "initial-turning": math.radians(10.0),
             "zig-zag": done.heading}.get(done.kind)  # fmt: skip
    name = f"zig-zag-{angle}" if done.kind == "zig-zag" else done.kind
    if done.helm is None or usual is None or math.isclose(done.helm, usual, rel_tol=1e-6):
        return name
    return f"{name} with a helm of {math.degrees(done.helm):g} deg"


def verdicts_of(done: Done, found: Figures) -> list[Verdict]:
    """Return the verdicts of MSC.137(76) on figures, if it is for the vessel: see `Done.criteria`.

    Raises InputError for a speed of none.
    """
    is_ship = done.length is not None and done.length >= SHIP
    if done.length is None or not (
        done.criteria == "imo" or (done.criteria == "length" and is_ship)
    ):
        return []
    return imo({criteria_name(done): found}, done.length, approach_speed_of(done, found))


def approach_speed_of(done: Done, figures: Figures) -> float:
    """Return the speed at the first order, m/s: through the water where the figures have it."""
    if "approach_speed" in figures:
        return figures["approach_speed"]
    return float(done.record.speed(done.record.start if done.first is None else done.first))


def _zig_zag(done: Done) -> Figures:
    figures = zig_zag(done.record, done.heading, done.first)
    return _with_second_order(done, _with_first_order(done, figures))


def _with_first_order(done: Done, figures: Figures) -> Figures:
    names = ("nomoto_K", "nomoto_T", "nomoto_delta_0", "nomoto_residual")
    try:
        model = nomoto(_after(done.record, done.first))
    except InputError as error:
        return _without(figures, names, error)
    values = (model.K, model.T, model.delta_0, model.residual)
    units = ("1/s", "s", "rad", "rad")
    found = {n: Figure(v, u) for n, v, u in zip(names, values, units, strict=True)}
    if done.length is not None:
        speed = approach_speed_of(done, figures)
        gain, lag = model.nondimensional(done.length, speed)
        found |= {"nomoto_K'": Figure(gain, "1"), "nomoto_T'": Figure(lag, "1")}
    return replace(figures, found={**figures.found, **found})


def _with_second_order(done: Done, figures: Figures) -> Figures:
    names = ("nomoto_T1", "nomoto_T2", "nomoto_T3")
    try:
        model = nomoto_second(_after(done.record, done.first))
    except InputError as error:
        return _without(figures, names, error)
    lags = zip(names, (model.T1, model.T2, model.T3), strict=True)
    return replace(figures, found={**figures.found, **{n: Figure(v, "s") for n, v in lags}})


def _without(figures: Figures, names: tuple[str, ...], error: InputError) -> Figures:
    return replace(figures, missing={**figures.missing, **dict.fromkeys(names, str(error))})


def _after(record: Record, order: float | None) -> Record:
    """Return the record from the last row before the order on."""
    if order is None:
        return record
    rows = slice(max(int(np.searchsorted(record.time, order)) - 1, 0), None)
    columns = {name: value[rows] for name, value in record.columns().items()}
    return Record(**columns)


def _spiral(done: Done) -> Figures:
    found = loop(*spiral_curve(done))
    unit = "rad/s" if done.length is None else "1"
    values = {"loop_height": Figure(found.height, unit), "loop_width": Figure(found.width, "rad")}
    return Figures("spiral", values)


def _reverse_spiral(done: Done) -> Figures:
    found = stability(*spiral_curve(done))
    values = {
        "neutral_helm": Figure(found.neutral_helm, "rad"),
        "helm_per_rate": Figure(found.slope, "s" if done.length is None else "rad"),
        "loop_width": Figure(found.width, "rad"),
    }
    return Figures("reverse spiral", values)


def spiral_curve(done: Done) -> tuple[Array, Array]:
    """Return helm, rad, and r' of the steps of a spiral; without a length the rate, rad/s."""
    orders = done.orders if done.kind == "reverse-spiral" else ()
    return spiral(_after(done.record, done.first), done.length, orders)


def _speed_trial(done: Done) -> Figures:
    ends = [*done.orders[1:], done.record.end]
    runs = [(max(end - done.window, first), end)
            for first, end in zip(done.orders[::2], ends[::2], strict=True)]  # fmt: skip
    return speed_trial(done.record, runs)


def _station(done: Done) -> Figures:
    record = _after(done.record, done.needed())
    north, east = done.record.place(done.record.start)
    return station_box(record, float(north), float(east), float(done.record.heading[0]))


def _depth_step(done: Done) -> Figures:
    if done.depth is None:
        raise InputError("depth step: the depth that it leads to is needed")
    return depth_step(done.record, done.needed(), done.depth)


FIGURES: Mapping[str, Callable[[Done], Figures]] = {
    "turning-circle": lambda done: turning_circle(done.record, done.first),
    "zig-zag": _zig_zag,
    "initial-turning": lambda done: initial_turning(done.record, done.heading, done.first),
    "pull-out": lambda done: pull_out(_after(done.record, done.needed(0)), done.needed(1)),
    "spiral": _spiral,
    "reverse-spiral": _reverse_spiral,
    "crash-stop": lambda done: stopping(done.record, done.needed()),
    "stopping": lambda done: stopping(done.record, done.needed(), done.share),
    "acceleration": lambda done: acceleration(done.record, done.needed()),
    "speed-trial": _speed_trial,
    "williamson": lambda done: williamson(done.record, done.first),
    "turn-on-the-spot": lambda done: turn_on_the_spot(done.record, done.first),
    "bollard-pull": lambda done: bollard_pull(done.record, done.needed()),
    "station-keeping": _station,
    "depth-step": _depth_step,
    "vertical-zig-zag": lambda done: pitch_zig_zag(done.record, done.heading, done.needed()),
}
"""Manoeuvres, and their figures."""
