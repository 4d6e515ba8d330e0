"""Predicted readings of the motion along one axis, with exact derivatives by its parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import casadi as ca
import numpy as np

from seatrial.model.expressions import Model, Vector
from seatrial.model.ports import Parameter

from .axis_motion import AxisMotion
from .sensitivity import sensitive_period

Reading = Literal["acceleration", "place"]
"""What a sensor reads: the acceleration along the axis, or the place on it."""

PARAMETERS = ("linear", "quadratic", "offset", "thrust", "time_constant")
STARTS = ("place_start", "velocity_start", "share_start")
UNKNOWNS = (*PARAMETERS, *STARTS, "bias")
"""What a prediction depends on: `AxisMotion`'s parameters, its state at the first sample, and the
bias of an accelerometer (0 for a reading of the place, which ``place_start`` shifts)."""

LONGEST_SUBSTEP = 0.025
"""s; a ``time_constant`` must not be shorter."""
_LEAST_SUBSTEPS = 4


@dataclass(frozen=True)
class Prediction:
    """A predicted reading, and how it depends on what is unknown."""

    reading: Vector
    """(n,)"""
    sensitivity: Vector
    """(n, unknowns): d(reading)/d(unknown), columns as `UNKNOWNS`."""


def delayed(command: Vector, samples: int) -> Vector:
    """Return the command ``samples`` later: beta(t - lambda); before the first, it is 0."""
    return np.concatenate([np.zeros(samples), command])[: len(command)]


def predict(
    motion: AxisMotion, reading: Reading, unknowns: Vector, command: Vector, period: float
) -> Prediction:
    """Return the reading at t = 0, period, ..., for commands that act from those instants on.

    The command (n,), delayed already, is held over each period; an acceleration is read just
    after the command has changed. From the equations of ``motion``, of which only the class
    and its texts matter, by the same Runge-Kutta step of order 4 that components take, in at
    least four sub-steps a period and none longer than 25 ms: with coarser ones the method's
    error, not noise, limits what identification finds. Angles are states, not sums.
    """
    if len(unknowns) != len(UNKNOWNS):
        raise ValueError(f"{len(UNKNOWNS)} unknowns are needed, found {len(unknowns)}")
    kind: Any = type(motion)
    run = _compiled(kind, motion.thrust_law, motion.lag, reading, len(command))
    substeps = max(_LEAST_SUBSTEPS, math.ceil(period / LONGEST_SUBSTEP - 1e-9))
    columns = run(unknowns, command, period, substeps)
    return Prediction(columns[:, 0], columns[:, 1:])


@lru_cache(maxsize=32)
def _compiled(kind: type[AxisMotion], law: str, lag: str, reading: Reading, count: int) -> Any:
    """Return a function of (unknowns, command, period, sub-steps): rows of reading, d/d(each)."""
    motion = kind()
    motion.set("thrust_law", law)
    motion.set("lag", lag)
    model = motion.compiled()
    steps: dict[int, Any] = {}

    def run(unknowns: Vector, command: Vector, period: float, substeps: int) -> Vector:
        if substeps not in steps:
            steps[substeps] = _step(kind, model, reading, substeps).mapaccum(count)
        start = np.zeros((len(STARTS), 1 + len(UNKNOWNS)))
        for row, state in enumerate(model.x_names):
            place = UNKNOWNS.index(f"{state}_start")
            start[row, [0, 1 + place]] = unknowns[place], 1.0
        given = np.tile(np.append(unknowns, period)[:, None], count)
        _states, rows = steps[substeps](start.ravel(order="F"), command[None, :], given)
        return np.asarray(rows).T

    return run


def _step(kind: type[AxisMotion], model: Model, reading: Reading, substeps: int) -> ca.Function:
    """Return `sensitive_period` of an axis, whose reading is one."""
    unknowns = ca.SX.sym("q", len(UNKNOWNS))
    p = _parameters(kind, dict(zip(UNKNOWNS, ca.vertsplit(unknowns), strict=True)))
    bias = unknowns[UNKNOWNS.index("bias")]
    place = model.x_names.index("place")

    def read(x: Any, command: Any) -> Any:
        return model.out(x, command, p) + bias if reading == "acceleration" else x[place]

    return sensitive_period(model, unknowns, p, read, substeps)


def _parameters(kind: type[AxisMotion], named: dict[str, Any]) -> Any:
    """Return the stacked real parameters of the plant; sub-steps and starts are given apart."""
    reals = [p for p in kind.ports.values() if isinstance(p, Parameter) and p.type is float]
    return ca.vertcat(*(named[p.name] if p.name in PARAMETERS else 0.0 for p in reals))
