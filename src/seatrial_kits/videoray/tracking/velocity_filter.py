"""Velocities of an underwater vehicle by an error-state Kalman filter."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.physics.craft.kinematics import rotation

_Array = NDArray[np.float64]
_V, _Z, _PSI, _BA, _BG = slice(0, 3), 3, 4, slice(5, 8), 8
_STATES = 9
_UVW = ("u", "v", "w")
_MEASURED = (
    *("euler", "imu_valid", "depth", "depth_valid"),
    *("velocity_b", "velocity_valid", "velocity_count", "model_valid"),
)


class VelocityFilter(Sampled):
    """Error-state Kalman filter of velocity, depth and heading with the inertial unit's biases.

    The nominal state, v over ground in {n}, depth z, heading psi, accelerometer bias b_a and bias
    b_g of the vertical gyro, goes on with the readings (J. Sola, "Quaternion kinematics for the
    error-state Kalman filter", 2017; roll and pitch are taken as measured, so that one angle is
    left of the attitude):

        v'   = R(phi, theta, psi) (f - b_a) + (0, 0, gravity)
        z'   = v_down
        psi' = (q sin phi + (r - b_g) cos phi) / cos theta

    The error dx = (dv, dz, dpsi, db_a, db_g) has, to first order, with k down and a = R (f - b_a),

        dv' = dpsi k x a - R db_a + noise,   dz' = dv_down,
        dpsi' = -db_g cos phi / cos theta + noise,   biases: random walks

    and is corrected, one measurement after the other, by heading (the shorter way across north),
    depth, and velocity in body axes from a Doppler log, each while it is valid and, for the log,
    when its ``velocity_count`` is new.

    With ``model_valid``, a model of the vehicle that has its commands bounds the error where there
    is no log: in still water, r as measured,

        m11 u' = E1 t1 + E2 t2 - d11 u - q11 |u| u + m22 v r
        m22 v' = -d22 v - q22 |v| v - m11 u r

    from rest, and its u and v are measurements too. A model errs slowly: its noise is taken as that
    of one independent value in ``model_time``, so that a hundred readings of it are not a hundred
    measurements. A current is an error of it.

    The covariance is updated in Joseph's form. ``deviation`` is what the filter expects of nu.

    Heading and depth come from sensors that are not delayed; a log's delay is not made up for.
    While the inertial readings are not valid the velocities are held and their variance grows.
    """

    exercised: ClassVar = {"velocity_valid": True, "velocity_count": 1}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    acceleration_noise = Parameter(
        0.06, "m/s2", "noise of a sample's acceleration, that of roll and pitch in it", min=1e-9
    )
    gyro_noise = Parameter(1e-3, "rad/s", "noise of a sample of the gyro", min=1e-9)
    heading_noise = Parameter(0.0035, "rad", "noise of a heading", min=1e-9)
    depth_noise = Parameter(0.01, "m", "noise of a depth", min=1e-9)
    velocity_noise = Parameter(0.01, "m/s", "noise of a velocity of the log, an axis", min=1e-9)
    model_noise = Parameter(0.03, "m/s", "standard error of the model's velocity", min=1e-9)
    model_time = Parameter(5.0, "s", "time in which the model's error is a new one", min=1e-9)
    mass = Parameter((1.0, 1.0), "kg", "mass with added mass, of the model", axes="uv", min=1e-9)
    damping = Parameter((0.0, 0.0), "N.s/m", "linear drag of the model", axes="uv", min=0.0)
    quadratic_damping = Parameter(
        (0.0, 0.0), "N.s2/m2", "quadratic drag of the model", axes="uv", min=0.0
    )
    thrust = Parameter((0.0, 0.0), "N", "full thrust of each thruster of it", axes=("t1", "t2"))
    acceleration_bias = Parameter(0.05, "m/s2", "deviation of the bias at the start", min=1e-9)
    acceleration_walk = Parameter(1e-4, "m/s2", "its random walk in 1 s", min=0.0)
    gyro_bias = Parameter(1e-3, "rad/s", "deviation of the gyro's bias at the start", min=1e-9)
    gyro_walk = Parameter(1e-5, "rad/s", "its random walk in 1 s", min=0.0)

    accelerometer = Input("m/s2", "specific force, body axes", axes="xyz", frame="b")
    gyro = Input("rad/s", "angular velocity, body axes", axes="xyz", frame="b")
    euler = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    imu_valid = Input("1", "whether the readings are valid", type=bool, start=True, optional=True)
    depth = Input("m", "depth, positive down")
    depth_valid = Input("1", "whether the depth is one", type=bool, start=True, optional=True)
    velocity_b = Input("m/s", "velocity over ground of a log, body axes", axes=_UVW, optional=True)
    velocity_valid = Input("1", "whether it is valid", type=bool, optional=True)
    velocity_count = Input("1", "number of readings of the log", type=int, optional=True)
    command = Input("1", "share of each thruster's full thrust", axes=("t1", "t2"), optional=True)
    model_valid = Input("1", "whether there is a model", type=bool, optional=True)

    nu = Output(("m/s", "m/s", "rad/s"), "velocity ahead and to starboard and yaw rate", axes="uvr")
    deviation = Output("m/s", "standard deviation of u and v that the filter expects", axes="uv")
    heading = Output("rad", "heading, 0 to 2 pi")

    terminals: ClassVar = {
        "sensors": terminal("accelerometer", "euler", "imu_valid", "depth", "depth_valid"),
    }

    def reset(self, t: float) -> None:
        """Start at rest, at the depth and heading of the first valid readings."""
        self._state: list[float] | None = None
        spread = [0.1, 0.1, 0.1, self.depth_noise, self.heading_noise]
        biases = [*[self.acceleration_bias] * 3, self.gyro_bias]
        self._covariance: list[list[float]] = np.diag(np.square([*spread, *biases])).tolist()
        self._readings = 0
        self._model = [0.0, 0.0]

    def sample(self, t: float, k: int) -> None:
        """Publish the estimate at this instant."""
        x, P = self._corrected()
        rates = self.gyro if self.imu_valid else (0.0, 0.0, 0.0)
        to_b = self._rotation(x[_PSI]).T
        u, v, _w = to_b @ x[_V]
        spread = to_b @ P[_V, _V] @ to_b.T
        self.nu = [float(u), float(v), rates[2] - float(x[_BG])]
        self.deviation = [math.sqrt(max(0.0, float(spread[i, i]))) for i in (0, 1)]
        self.heading = float(x[_PSI]) % math.tau

    def update(self, t: float, k: int) -> None:
        """Correct, then go on to the next instant; begin with the first valid readings."""
        if self._state is None and not (self.imu_valid and self.depth_valid):
            return
        x, P = self._corrected()
        self._readings = self.velocity_count
        if self.model_valid:
            self._model = self._modelled(self.gyro[2] - float(x[_BG]) if self.imu_valid else 0.0)
        x, P = self._predicted(x, P)
        self._state, self._covariance = x.tolist(), P.tolist()

    def _rotation(self, heading: float) -> _Array:
        return np.array(rotation(self.euler[0], self.euler[1], heading))

    def _corrected(self) -> tuple[_Array, _Array]:
        """Return state and covariance with the measurements of this instant."""
        P = np.array(self._covariance)
        if self._state is None:  # which is what heading and depth are at the first instant
            x = np.array([0.0] * 3 + [self.depth, self.euler[2]] + [0.0] * 4)
        else:
            x, P = self._by_attitude_and_depth(np.array(self._state), P)
        if self.velocity_valid and self.velocity_count != self._readings:
            x, P = self._by_velocity(x, P, self.velocity_b, self.velocity_noise**2)
        if self.model_valid:
            # A standing error of the model, spread over the samples of its correlation time.
            variance = self.model_noise**2 * max(1.0, self.model_time / self.period)
            x, P = self._by_velocity(x, P, self._model, variance)
        return x, P

    def _by_attitude_and_depth(self, x: _Array, P: _Array) -> tuple[_Array, _Array]:
        if self.imu_valid:
            error = np.array([math.remainder(self.euler[2] - x[_PSI], math.tau)])
            x, P = _correct(x, P, _row(_PSI), error, self.heading_noise**2)
        if self.depth_valid:
            x, P = _correct(x, P, _row(_Z), np.array([self.depth - x[_Z]]), self.depth_noise**2)
        return x, P

    def _by_velocity(
        self, x: _Array, P: _Array, measured: Any, variance: float
    ) -> tuple[_Array, _Array]:
        """Correct by a velocity in body axes: all three axes, or the first two."""
        count = len(measured)
        to_b = self._rotation(x[_PSI]).T
        H = np.zeros((count, _STATES))
        H[:, _V] = to_b[:count]
        H[:, _PSI] = -(to_b @ np.cross((0.0, 0.0, 1.0), x[_V]))[:count]
        return _correct(x, P, H, np.array(measured) - (to_b @ x[_V])[:count], variance)

    def _modelled(self, r: float) -> list[float]:
        """Return u and v of the model a period later."""
        (m11, m22), (d11, d22), (q11, q22) = self.mass, self.damping, self.quadratic_damping
        u, v = self._model
        X = sum(E * share for E, share in zip(self.thrust, self.command, strict=True))
        ahead = (X - d11 * u - q11 * abs(u) * u + m22 * v * r) / m11
        abeam = (-d22 * v - q22 * abs(v) * v - m11 * u * r) / m22
        return [u + self.period * ahead, v + self.period * abeam]

    def _predicted(self, x: _Array, P: _Array) -> tuple[_Array, _Array]:
        """Return state and covariance a period later."""
        T, R, x = self.period, self._rotation(x[_PSI]), x.copy()
        phi, theta, _ = self.euler
        F = np.eye(_STATES)
        if self.imu_valid:
            force = R @ (np.array(self.accelerometer) - x[_BA])
            F[_V, _PSI] = T * np.cross((0.0, 0.0, 1.0), force)
            F[_V, _BA] = -T * R
            F[_Z, _BA] = -(T**2) / 2 * R[2]
            F[_PSI, _BG] = -T * math.cos(phi) / math.cos(theta)
            turning = self.gyro[1] * math.sin(phi) + (self.gyro[2] - x[_BG]) * math.cos(phi)
            acceleration = force + np.array((0.0, 0.0, self.gravity))
            x[_Z] += T * x[2] + T**2 / 2 * acceleration[2]
            x[_V] += T * acceleration
            x[_PSI] += T * turning / math.cos(theta)
        else:
            x[_Z] += T * x[2]
        F[_Z, 2] = T
        walk = np.array([*[self.acceleration_walk] * 3, self.gyro_walk])
        noise = np.zeros(_STATES)
        noise[_V] = (T * self.acceleration_noise) ** 2
        noise[_PSI] = (T * self.gyro_noise) ** 2
        noise[5:] = T * walk**2
        return x, F @ P @ F.T + np.diag(noise)


def _row(index: int) -> _Array:
    H = np.zeros((1, _STATES))
    H[0, index] = 1.0
    return H


def _correct(
    x: _Array, P: _Array, H: _Array, error: _Array, variance: float
) -> tuple[_Array, _Array]:
    """Return the state and covariance after measurements H dx = ``error`` of that variance."""
    V = variance * np.eye(len(error))
    gain = np.linalg.solve(H @ P @ H.T + V, H @ P).T
    kept = np.eye(_STATES) - gain @ H
    return x + gain @ error, kept @ P @ kept.T + gain @ V @ gain.T
