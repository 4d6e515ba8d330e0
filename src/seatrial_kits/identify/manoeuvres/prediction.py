"""Prediction of a pass by the vehicle's own equations, with its derivatives by the unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from seatrial.errors import InputError
from seatrial.fmi.compiled_functions import compiled_function
from seatrial.model.expressions import Vector
from seatrial_kits.sea_trials.figures.record import Record

from ..sensitivity import sensitive_period
from .craft import Craft
from .passes import thinned
from .replay import Inputs

READINGS = ("north", "east", "heading")
"""Columns of a record that are predicted."""
STARTS = ("north", "east", "heading", "u", "v", "r")
"""States at the first row that are unknown; u and v are through the water."""
CURRENT = ("current north", "current east")
MOST_ROWS = 1200
"""Rows of a pass that are compared; more are thinned."""
_SETTLING = 30.0
"""How long the first inputs act on the craft before the first row, s."""
_GUESSED = 20.0
"""Longest time over which the first velocity is guessed, s; at most a tenth of the record is."""
_LEAST = 8
_LONGEST, _ACCURACY = 2.0, 1e-5
"""Longest step of the integration, s, and the share of the span that a longer step may change."""


@dataclass(frozen=True)
class Motion:
    """A pass as the equations take it, on a grid of times that contains its rows."""

    record: Record
    """Thinned."""
    rows: Vector
    """(n,) places of its rows in the grid."""
    steps: Vector
    """(g,) s; the last is only there to read the last row."""
    inputs: Vector
    """(m, g), the mean over each step."""
    start: Vector
    """State at the first row, a guess where it is among `STARTS`."""
    source: Inputs
    """What ``inputs`` are the means of."""

    @property
    def measured(self) -> Vector:
        """The readings (3, n) of the record."""
        return np.array([getattr(self.record, name) for name in READINGS])


class Predictor:
    """Readings (3, n) of a pass, and their derivatives by the unknowns.

    Unknowns are the relative changes theta of the free parameters p = p_file (1 + theta), the
    current over ``speed``, north and east, and `STARTS`. Positions are those through the water plus
    the current times the time: in water that moves uniformly the same orders give the same
    motion. Runge-Kutta of order 4 with the mean of the inputs over each step, and exact derivatives
    of its steps, as machine code if there is a compiler.
    """

    def __init__(self, craft: Craft, motion: Motion, free: Sequence[str], speed: float) -> None:
        self.motion, self._speed, self._count = motion, speed, len(free)
        model, names = craft.model, list(craft.parameters)
        self._starts = craft.places(STARTS)
        theta = ca.SX.sym("theta", len(free))
        starts = ca.SX.sym("start", len(STARTS))
        known = ca.SX.sym("known", len(names))
        p = ca.SX(known)
        for place, name in enumerate(free):
            p[names.index(name)] *= 1 + theta[place]
        self._moved = _moved(model.rhs, self._starts, [names.index(name) for name in free])
        places = craft.places(READINGS)
        unknowns = ca.vertcat(theta, starts)
        step = sensitive_period(model, unknowns, p, lambda x, _: x[places], 1, self._moved, known)
        self._known = np.array(list(craft.parameters.values()))
        self._run = compiled_function(step).mapaccum(len(motion.steps), {"base": 8})
        self.elapsed = motion.record.time - motion.record.start

    def __call__(self, unknowns: Vector) -> tuple[Vector, Vector]:
        """Return readings (3, n) and derivatives (3, n, k) at unknowns (k,)."""
        theta, current = unknowns[: self._count], unknowns[self._count : self._count + 2]
        starts = unknowns[self._count + 2 :]
        k = len(theta) + len(starts)
        x = self.motion.start.copy()
        x[self._starts] = starts
        slopes = np.zeros((len(self._moved), k))
        rows = [self._moved.index(state) for state in self._starts]
        slopes[rows, range(self._count, k)] = 1.0
        same = np.concatenate((theta, starts, self._known, [0.0]))
        given = np.tile(same[:, None], len(self.motion.steps))
        given[-1] = self.motion.steps
        first = np.concatenate((x, slopes.ravel(order="F")))
        _, found = self._run(first, self.motion.inputs, given)
        columns = np.asarray(found)[:, self.motion.rows].reshape(1 + k, len(READINGS), -1)
        readings, by_own = columns[0].copy(), columns[1:].transpose(1, 2, 0)
        readings[:2] += self._speed * current[:, None] * self.elapsed
        by_current = np.zeros((len(READINGS), len(self.elapsed), 2))
        by_current[0, :, 0] = by_current[1, :, 1] = self._speed * self.elapsed
        parts = by_own[..., : self._count], by_current, by_own[..., self._count :]
        return readings, np.concatenate(parts, axis=2)


def motion_of(craft: Craft, record: Record, inputs: Inputs) -> Motion:
    """Return a pass on the grid that the equations need.

    The step is the longest up to 2 s whose track differs from that of half the step by no more
    than 1e-5 of the span; the craft's own longest step is always taken. States that are neither
    unknown nor measured are those after 30 s of the first inputs, or those of a craft at rest.
    Raises InputError if the equations do not follow the inputs.
    """
    start = _first_state(craft, record, inputs)
    shown = thinned(record, MOST_ROWS)
    usual = float(np.median(np.diff(shown.time)))
    step = min(_LONGEST, usual)
    fine = float(craft.plant.max_step)
    tried = _on_grid(shown, inputs, start, step)
    track = _track(craft, tried)
    while step > fine:
        half = _on_grid(shown, inputs, start, step / 2.0)
        finer = _track(craft, half)
        apart = np.abs(track - finer).max() if np.isfinite(track).all() else np.inf
        if apart <= _ACCURACY * max(float(np.ptp(finer)), 1e-9):
            return tried
        step, tried, track = step / 2.0, half, finer
    if not np.isfinite(track).all():
        raise InputError(f"the equations of {craft.name} do not follow the recorded orders")
    return tried


def _on_grid(shown: Record, inputs: Inputs, start: Vector, step: float) -> Motion:
    lengths = np.diff(shown.time)
    counts = np.maximum(np.ceil(lengths / step - 1e-9), 1.0).astype(int)
    steps = np.append(np.repeat(lengths / counts, counts), step)
    begins = shown.start + np.concatenate(([0.0], np.cumsum(steps[:-1])))
    given = inputs.means(np.append(begins, begins[-1] + step))
    return Motion(shown, np.concatenate(([0], np.cumsum(counts))), steps, given, start, inputs)


def halved(motion: Motion) -> Motion:
    """Return a pass with steps of half the length."""
    step = float(motion.steps.max()) / 2.0
    return _on_grid(motion.record, motion.source, motion.start, step)


def _track(craft: Craft, motion: Motion) -> Vector:
    """Return the track (2, n) by the parameters of the file."""
    run = compiled_function(craft.model.rk4).mapaccum(len(motion.steps), {"base": 8})
    p = np.tile(np.array(list(craft.parameters.values()))[:, None], len(motion.steps))
    states = np.asarray(run(motion.start, motion.inputs, p, motion.steps[None, :]))
    places = craft.places(READINGS[:2])
    return np.column_stack((motion.start[:, None], states[:, :-1]))[places][:, motion.rows]


def _first_state(craft: Craft, record: Record, inputs: Inputs) -> Vector:
    p, step = np.array(list(craft.parameters.values())), float(craft.plant.max_step)
    x = craft.start.copy()
    first = _guess(record)
    x[craft.places(("u", "v", "r"))] = first["u"], first["v"], first["r"]
    for _ in range(0 if inputs.from_rest else round(_SETTLING / step)):
        x = np.asarray(craft.model.rk4(x, inputs.values[0], p, step)).ravel()
    if not np.isfinite(x).all():
        raise InputError(f"the equations of {craft.name} do not settle with the first orders")
    for name, value in first.items():
        place = craft.place(name)
        if place is not None:
            x[place] = value
    return x


def _guess(record: Record) -> dict[str, float]:
    """Return what the first rows show: position, angles and velocity."""
    length = min(_GUESSED, 0.1 * (record.end - record.start))
    last = max(int(np.searchsorted(record.time, record.start + length)), _LEAST)
    elapsed = record.time[:last] - record.start
    columns = np.column_stack((record.north, record.east, record.heading))
    _, (v_n, v_e, r), (_, _, psi) = np.polyfit(elapsed, columns[:last], 2)
    found = {"north": float(record.north[0]), "east": float(record.east[0]), "heading": float(psi)}
    found |= {
        "u": v_n * np.cos(psi) + v_e * np.sin(psi),
        "v": v_e * np.cos(psi) - v_n * np.sin(psi),
    }
    found["r"] = float(r)
    measured = {"depth": record.depth, "roll": record.roll, "pitch": record.pitch}
    return found | {name: float(each[0]) for name, each in measured.items() if each is not None}


def _moved(rhs: ca.Function, starts: Sequence[int], free: Sequence[int]) -> list[int]:
    """Return the states that depend on the unknowns, by the equations' structure."""
    by_state = np.array(ca.DM(rhs.jac_sparsity(0, 0), 1)).astype(bool)
    by_parameter = np.array(ca.DM(rhs.jac_sparsity(0, 2), 1)).astype(bool)
    moved = np.asarray(by_parameter[:, list(free)].any(axis=1))
    moved[list(starts)] = True
    while True:
        more = moved | by_state[:, moved].any(axis=1)
        if (more == moved).all():
            return np.flatnonzero(moved).tolist()
        moved = more
