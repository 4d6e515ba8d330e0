"""Stepper motor with a gear: steps in, shaft angle out, lost steps where the load is too much."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.devices.actuators.actuator import Actuator
from seatrial.model.component import Input, Output, Parameter


class Stepper(Actuator):
    """Two-phase stepper motor behind a gear, its field turned by counted steps.

    With theta_f the field's angle, theta the rotor's, z = steps_per_turn / 4 pole pairs, psi =
    z (theta_f - theta), tau the load at the rotor, T the holding torque at this current:

        T    = holding_torque current / rated_current
        psi' = z (omega_f - omega),    omega = (T sin psi + tau) / D,    D = T / pull_out_rate
        angle = angle_start + theta / gear,    tau = load / gear

    a rotor without inertia against friction, of which each step takes the exact solution. So

    - at rest it holds as long as |tau| < T, off by asin(tau / T) / z;
    - turning at omega it pulls a load of T - D omega, and none at ``pull_out_rate``;
    - beyond, psi slips by turns: each is four full steps lost, which nobody who counts pulses sees.
      Under a load of tau > T it slips sqrt(tau^2 - T^2) z / (2 pi D) turns of psi a second.

    ``steps`` counts pulses, whole or micro steps, positive those that turn the shaft to positive
    angles; those of a step are taken as even in it. Not ``enabled``, it has no torque and turns
    freely against D. ``power`` is what windings and load take, current^2 resistance and the work
    done against the load; D stands for the current that a fast motor lacks, and costs nothing.
    Angles rad, torques N.m at the shaft named.

    Failures are those of `Actuator`: garbage are steps to anywhere within a turn of the motor; a
    wrong one has half of the torque; a slow one takes a tenth of the pulses; where nothing
    arrives, and stuck, the field stays.

    Defaults: a motor of size NEMA 23 (1.8 degrees, 1.26 N.m at 2.8 A, 0.9 ohm), as data sheets give
    it; assumed: 1/8 steps, a gear of 20, no torque at 1000 full steps a second.

    Not modelled: inertia and resonance, detent torque, torque of micro steps, friction and backlash
    of the gear, heat.
    """

    exercised: ClassVar = {"gear": 1.0, "holding_torque": 2.0, "steps_per_turn": 8.0}

    steps_per_turn = Parameter(200.0, "1", "full steps of a turn of the motor", min=4.0)
    microsteps = Parameter(8.0, "1", "pulses of a full step", min=1.0, max=256.0)
    gear = Parameter(20.0, "1", "turns of the motor for one of the shaft", min=1e-3)
    holding_torque = Parameter(1.26, "N.m", "holding torque at the rated current", min=1e-6)
    rated_current = Parameter(2.8, "A", "current of a phase for that", min=1e-6)
    pull_out_rate = Parameter(
        10.0 * math.pi, "rad/s", "speed of the motor at which it has no torque left", min=1e-6
    )
    resistance = Parameter(0.9, "ohm", "of a phase", min=0.0)
    angle_start = Parameter(0.0, "rad", "angle of the shaft at the start")
    current = Parameter(2.8, "A", "current that the driver is set to", min=0.0, tunable=True)

    steps = Input("1", "pulses counted since the start", type=int)
    load = Input("N.m", "torque of the load on the shaft", optional=True)
    enabled = Input(
        "1", "whether its driver gives it current", type=bool, start=True, optional=True
    )

    angle = Output("rad", "angle of the shaft")
    rate = Output("rad/s", "rate of the shaft, mean of the last step")
    lag = Output("rad", "electrical angle from rotor to field, -pi to pi")
    lost = Output("1", "full steps lost since the start, with their sign", type=int)
    stalled = Output("1", "whether it lost steps in the last step", type=bool)
    power = Output("W", "drawn from the supply")

    def start(self, t: float) -> None:
        """Start in line with the field, at ``angle_start``."""
        self._field, self._lag = 0.0, 0.0
        self._angle, self._rate, self._slipped = self.angle_start, 0.0, False
        self._work, self._counted = 0.0, 0
        self.begin_at(0.0)

    def step(self, t: float, h: float) -> None:
        """Turn the field by the pulses of this step, and the rotor after it."""
        turn = self.steps_per_turn * self.microsteps
        arrived = self.take(t, [float(self.steps)], [self.steps - turn], [self.steps + turn])
        counted = self._counted if arrived is None or self.fault == "stuck" else round(arrived[0])
        pulses, self._counted = counted - self._counted, counted
        turned = math.tau * pulses / turn / self.slowness
        pairs, torque, friction = self.steps_per_turn / 4.0, self._torque(), self._friction()
        field_rate = turned / h
        before = self._lag
        self._lag = slipped(
            self._lag,
            pairs * (field_rate - self.load / self.gear / friction),
            pairs * torque / friction,
            h,
        )
        self._field += turned
        angle = self.angle_start + (self._field - self._lag / pairs) / self.gear
        self._rate, self._angle = (angle - self._angle) / h, angle
        self._slipped = _turns(before) != _turns(self._lag)
        self._work = max(0.0, -self.load * self._rate)

    def outputs(self, t: float) -> None:
        """Publish where the shaft is, and what the driver does not know."""
        self.angle, self.rate = self._angle, self._rate
        self.lag = math.remainder(self._lag, math.tau)
        self.lost, self.stalled = 4 * _turns(self._lag), self._slipped
        drawn = self.current**2 * self.resistance + self._work
        self.power = drawn if self.enabled else 0.0

    def _torque(self) -> float:
        """Return the greatest torque of the field on the rotor, N.m."""
        share = self.current / self.rated_current if self.enabled else 0.0
        torque: float = self.holding_torque * share * self.effect
        return torque

    def _friction(self) -> float:
        """Return D, N.m.s/rad: that of the rated current."""
        friction: float = self.holding_torque / self.pull_out_rate
        return friction


def _turns(lag: float) -> int:
    return round(lag / math.tau)


def slipped(lag: float, drift: float, pull: float, h: float) -> float:
    """Return psi after ``h`` seconds of psi' = drift - pull sin psi, from ``lag``; all rad and s.

    The direction of (cos psi/2, sin psi/2) turns by a linear equation, of which this is the
    solution; psi keeps its whole turns. ``pull`` is not negative.
    """
    half = 0.5 * lag
    c, s = math.cos(half), math.sin(half)
    squared = 0.25 * (pull * pull - drift * drift)
    k = math.sqrt(abs(squared))
    if squared < 0.0:
        whole, rest = divmod(k * h, math.pi)
        grown, ratio = math.cos(rest), math.sin(rest) / k
    else:
        whole, grown = 0.0, 1.0
        ratio = math.tanh(k * h) / k if k * h > 1e-12 else h
    s_after = grown * s + ratio * 0.5 * (drift * c - pull * s)
    c_after = grown * c + ratio * 0.5 * (pull * c - drift * s)
    # Less than half a turn of the half angle is left, in the direction of psi'.
    moved = math.atan2(s_after * c - c_after * s, s_after * s + c_after * c)
    if squared < 0.0 and moved * drift < 0.0:
        moved += math.copysign(math.pi, drift) if abs(moved) > 1e-9 else 0.0
    return lag + 2.0 * (moved + math.copysign(whole * math.pi, drift))
