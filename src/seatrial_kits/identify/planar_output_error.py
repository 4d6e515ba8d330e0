"""Output-error identification of sway, and of each thruster, from a log of a vehicle's turns."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from seatrial.model.expressions import Vector
from seatrial.model.plant import Plant, State
from seatrial.model.ports import Input, Output, Parameter

from .output_error import covariances
from .prediction import LONGEST_SUBSTEP, delayed
from .sensitivity import sensitive_period
from .source_method import PlanarEstimate, differences, integrated, planar_least_squares

PARAMETERS = ("mass", "linear", "quadratic", "thrust_1", "thrust_2")
"""What a log of turns shows: sway mass and drags, and both thrusters' full thrust."""
_STARTS = ("heading", "u", "v", "r")
_SHARES = ("share_1", "share_2")
_BIASES = ("bias_x", "bias_y")
UNKNOWNS = (*PARAMETERS, *_STARTS, *_SHARES, *_BIASES)
_POSITIVE = {"mass": 1e-6, "linear": 0.0, "quadratic": 0.0}
_LEAST_SUBSTEPS = 2
_ROUNDS = 3
"""Fits, each weighted by the residual that the one before left of each reading."""


@dataclass(frozen=True)
class PlanarKnown:
    """What surge and yaw have shown: [Paulino2015], section 5.3, takes it from their own runs."""

    mass: tuple[float, float]
    """m11 in kg and m33 in kg.m2, with added mass."""
    linear: tuple[float, float]
    """Drag d11 in N.s/m and d33 in N.m.s/rad, positive."""
    quadratic: tuple[float, float]
    """N.s2/m2 and N.m.s2/rad2."""
    arm: float
    """Thrusters from the centre line, m."""
    delay: float
    """s."""
    time_constant: float
    """Lag of the thrust, s."""


@dataclass(frozen=True)
class PlanarLog:
    """A log of turns at equal times."""

    commands: Vector
    """(n, 2): port (1) and starboard thruster, -1 to 1, as they were sent."""
    readings: Vector
    """(n, 3): acceleration ahead and to starboard without gravity, m/s2, and heading, rad."""
    period: float
    """s."""
    before: Vector
    """(k, 2): commands before the first row, the last one period before it; earlier ones are 0."""

    def part(self, first: int, last: int) -> PlanarLog:
        """Return the samples ``first`` to before ``last``."""
        before = np.vstack([self.before, self.commands[:first]])
        return replace(
            self,
            commands=self.commands[first:last],
            readings=self.readings[first:last],
            before=before,
        )

    def late(self, delay: float) -> Vector:
        """Return the commands (n, 2) that act at each row if they are late by ``delay``, s.

        In whole samples, as those of a log are: raises ValueError for a delay between two.
        """
        samples = round(delay / self.period)
        if abs(samples * self.period - delay) > 1e-6:
            raise ValueError(f"{delay!r} s is no whole number of samples of {self.period!r} s")
        sent = np.vstack([self.before, self.commands])
        late = np.column_stack([delayed(column, samples) for column in sent.T])
        return late[len(self.before) :]


@dataclass(frozen=True)
class PlanarFit:
    """What the best simulation found."""

    values: dict[str, float]
    """By name, as `UNKNOWNS`: kg, N.s/m, N.s2/m2, N, N; state at the first sample, biases."""
    free: tuple[str, ...]
    covariance: Vector
    """(free, free), with the correlation of the residual taken into account."""
    scales: Vector
    """(3,): root mean square of the residual of each reading, m/s2, m/s2, rad."""
    residual: Vector
    """(n, 3) measured less predicted."""

    def deviation(self, name: str) -> float:
        """Return the standard deviation of a value; 0 for what was not looked for."""
        if name not in self.free:
            return 0.0
        place = self.free.index(name)
        return math.sqrt(float(self.covariance[place, place]))


def planar_output_error(log: PlanarLog, known: PlanarKnown) -> PlanarFit:
    """Return sway and thrust whose simulation is nearest to what was measured.

    Minimises the sum of squares of measured less simulated accelerations and heading, each
    divided by the root mean square of its own residual, which three rounds find, over `UNKNOWNS`.
    Surge and yaw are ``known``, and so are delay and lag: the equation of sway alone has no force
    that would show a mass, only m22 / m11. Exact gradients; see `output_error` for why
    the simulation sees no measured velocity. Raises ValueError for a delay that is no whole
    number of samples.
    """
    free = UNKNOWNS if _lags(known) else tuple(n for n in UNKNOWNS if n not in _SHARES)
    return _rounds(log, known, free, _guess(log, known))


def planar_simulated(log: PlanarLog, known: PlanarKnown, found: PlanarFit) -> Vector:
    """Return a free run (n, 3) of what was found, over a log that need not be that of the fit.

    The state at the first sample and the biases of the accelerometers alone are fitted to it.
    """
    own = tuple(name for name in found.free if name not in PARAMETERS)
    start = np.array([found.values[name] if name in PARAMETERS else 0.0 for name in UNKNOWNS])
    start[UNKNOWNS.index("heading")] = log.readings[0, 2]
    return log.readings - _rounds(log, known, own, start).residual


def as_the_source(log: PlanarLog, known: PlanarKnown) -> PlanarEstimate:
    """Return what [Paulino2015], eqs 5.20 and 5.21, makes of a log, its signs corrected.

    Velocities by discrete integration of the accelerations, yaw rate and its change by
    differences of the heading; linear drag.
    """
    a_x, a_y, heading = log.readings.T
    rate, change = differences(heading, log.period)
    u, v = (integrated(a, log.period) for a in (a_x, a_y))
    return planar_least_squares(
        np.column_stack([u, v, rate]),
        np.column_stack([a_x, a_y, change]),
        log.late(known.delay),
        m11=known.mass[0],
        m33=known.mass[1],
        d11=known.linear[0],
        d33=known.linear[1],
        arm=known.arm,
    )


def _lags(known: PlanarKnown) -> bool:
    return known.time_constant >= LONGEST_SUBSTEP


def _guess(log: PlanarLog, known: PlanarKnown) -> Vector:
    """Return where to start from: sway as surge, thrust from the acceleration ahead."""
    both = log.late(known.delay).sum(axis=1)
    ahead = known.mass[0] * log.readings[:, 0]
    thrust = float(both @ ahead) / max(float(both @ both), 1e-12)
    values = {"mass": known.mass[0], "linear": known.linear[0], "quadratic": known.quadratic[0]}
    values |= {"thrust_1": thrust, "thrust_2": thrust, "heading": float(log.readings[0, 2])}
    return np.array([values.get(name, 0.0) for name in UNKNOWNS])


def _rounds(
    log: PlanarLog, known: PlanarKnown, free: tuple[str, ...], unknowns: Vector
) -> PlanarFit:
    from scipy.optimize import least_squares

    predict = _predictor(log, known)
    places = [UNKNOWNS.index(name) for name in free]
    lower = np.array([_POSITIVE.get(name, -np.inf) for name in free])
    scales = np.maximum(log.readings.std(axis=0), 1e-12)
    unknowns = unknowns.copy()
    jacobian = np.zeros((3 * len(log.commands), len(free)))

    def residual(z: Vector) -> Vector:
        unknowns[places] = z
        predicted, sensitivity = predict(unknowns)
        jacobian[:] = -(sensitivity[:, :, places] / scales[:, None, None]).reshape(jacobian.shape)
        weighted: Vector = ((log.readings.T - predicted) / scales[:, None]).ravel()
        return weighted

    for _ in range(_ROUNDS):
        found = least_squares(
            residual,
            np.maximum(unknowns[places], lower + 1e-9),
            jac=lambda z: jacobian.copy(),
            bounds=(lower, np.inf),
            x_scale="jac",
            max_nfev=100,
        )
        left = residual(found.x).reshape(3, -1) * scales[:, None]
        used, scales = scales, np.maximum(np.sqrt(np.mean(left**2, axis=1)), 1e-12)
    _, coloured = covariances(jacobian, (left / used[:, None]).ravel())
    values = dict(zip(UNKNOWNS, unknowns.tolist(), strict=True))
    return PlanarFit(values, free, coloured, scales, left.T)


Predictor = Callable[[Vector], tuple[Vector, Vector]]


def _predictor(log: PlanarLog, known: PlanarKnown) -> Predictor:
    """Return a function of the unknowns: readings (3, n), and their sensitivities (3, n, k)."""
    motion = PlanarMotion("planar")
    motion.set("lag", "thruster" if _lags(known) else "none")
    model = motion.compiled()
    count = len(log.commands)
    substeps = max(_LEAST_SUBSTEPS, math.ceil(log.period / LONGEST_SUBSTEP - 1e-9))
    q = ca.SX.sym("q", len(UNKNOWNS))
    named = dict(zip(UNKNOWNS, ca.vertsplit(q), strict=True))
    p = _parameters(known, named)
    biases = ca.vertcat(*(named[name] for name in _BIASES))

    def read(x: Any, command: Any) -> Any:
        return ca.vertcat(model.out(x, command, p) + biases, x[0])

    run = sensitive_period(model, q, p, read, substeps).mapaccum(count)
    commands = log.late(known.delay).T
    starts = (*_STARTS, *_SHARES)

    def predict(unknowns: Vector) -> tuple[Vector, Vector]:
        start = np.zeros((len(starts), 1 + len(UNKNOWNS)))
        for row, name in enumerate(starts):
            place = UNKNOWNS.index(name)
            start[row, [0, 1 + place]] = unknowns[place], 1.0
        given = np.tile(np.append(unknowns, log.period)[:, None], count)
        _states, rows = run(start.ravel(order="F"), commands, given)
        columns = np.asarray(rows).reshape(1 + len(UNKNOWNS), 3, count)
        return columns[0], columns[1:].transpose(1, 2, 0)

    return predict


def _parameters(known: PlanarKnown, named: dict[str, Any]) -> Any:
    """Return the stacked real parameters of `PlanarMotion`, known and looked for."""
    values: dict[str, Any] = {
        name: ca.vertcat(at[0], named[name], at[1])
        for name, at in (
            ("mass", known.mass),
            ("linear", known.linear),
            ("quadratic", known.quadratic),
        )
    }
    values |= {
        "thrust": ca.vertcat(named["thrust_1"], named["thrust_2"]),
        "arm": known.arm,
        "time_constant": max(known.time_constant, 1e-6),
    }
    ports = PlanarMotion.ports.values()
    reals = [port for port in ports if isinstance(port, Parameter) and port.type is float]
    return ca.vertcat(*(values.get(port.name, ca.DM.zeros(port.size)) for port in reals))


_UVR = ("u", "v", "r")


class PlanarMotion(Plant):
    """Surge, sway and yaw in still water under two thrusters ahead, with no force in sway.

        m11 u' = E1 s1 + E2 s2 - D_u(u) + m22 v r
        m22 v' =               - D_v(v) - m11 u r              D_i(x) = (d_i + q_i |x|) x
        m33 r' = arm (E1 s1 - E2 s2) - D_r(r) + (m11 - m22) u v

    [Paulino2015], eq. 5.18, with its missing lever arm and, of ours, the quadratic drag q that it
    sets aside here. ``mass`` has the added mass, thruster 1 ahead turns to starboard. s is each
    thruster's share of its full thrust E: with ``lag`` "none" the command, with "thruster"
    T s' = command - s.

    ``acceleration`` is (u' - v r, v' + u r), what accelerometers along bow and starboard read
    without gravity; the heading is not wrapped.

    Not modelled: heave, roll and pitch, current, tether, a centre of gravity off the origin.
    """

    lag = Parameter("none", "1", "what delays the thrust", choices=("none", "thruster"))
    mass = Parameter(1.0, ("kg", "kg", "kg.m2"), "with added mass", axes=_UVR, min=1e-9)
    linear = Parameter(
        0.0, ("N.s/m", "N.s/m", "N.m.s/rad"), "linear drag, positive", axes=_UVR, min=0.0
    )
    quadratic = Parameter(
        0.0, ("N.s2/m2", "N.s2/m2", "N.m.s2/rad2"), "quadratic drag, positive", axes=_UVR, min=0.0
    )
    thrust = Parameter(1.0, "N", "thrust of each thruster at command 1", axes=("t1", "t2"))
    arm = Parameter(1.0, "m", "thrusters from the centre line", min=1e-9)
    time_constant = Parameter(0.15, "s", "time constant of the thrust, with a lag", min=1e-6)
    command = Input("1", "share of each thruster's full thrust, -1 to 1", axes=("t1", "t2"))
    heading = State("rad", "heading, clockwise, not wrapped")
    velocity = State(("m/s", "m/s", "rad/s"), "velocity in body axes and yaw rate", axes=_UVR)
    share = State("1", "share of full thrust, with a lag", axes=("t1", "t2"))
    acceleration = Output("m/s2", "acceleration of the body origin, body axes", axes="xy")

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of heading, velocity and shares, and the acceleration."""
        has_lag = p.lag == "thruster"
        first, second = ca.vertsplit(p.thrust * (x.share if has_lag else u.command))
        surge, sway, yaw = ca.vertsplit(x.velocity)
        m11, m22, _ = ca.vertsplit(p.mass)
        coupling = ca.vertcat(m22 * sway * yaw, -m11 * surge * yaw, (m11 - m22) * surge * sway)
        thrust = ca.vertcat(first + second, 0, p.arm * (first - second))
        drag = (p.linear + p.quadratic * ca.fabs(x.velocity)) * x.velocity
        change = (thrust - drag + coupling) / p.mass
        slopes = {
            "heading": yaw,
            "velocity": change,
            "share": (u.command - x.share) / p.time_constant if has_lag else ca.DM.zeros(2),
        }
        carried = ca.vertcat(change[0] - sway * yaw, change[1] + surge * yaw)
        return slopes, {"acceleration": carried}
