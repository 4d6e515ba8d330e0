"""Main engine of a ship: telegraph, governor, limits of torque, and the shaft of the propeller."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.devices.actuators.actuator import Actuator
from seatrial.errors import InputError, unknown
from seatrial.model.component import Input, Output, Parameter

REMOTE, STOP = "remote", "stop"
STEPS = ("dead slow", "slow", "half", "full")
AHEAD, ASTERN = (tuple(f"{step} {side}" for step in STEPS) for side in ("ahead", "astern"))
ORDERS = (REMOTE, STOP, *AHEAD, *ASTERN)


class MarineEngine(Actuator):
    """Engine, governor and shaft that turn the propeller of a ship.

    The order is the ``command``, a share of ``rated_speed`` (n_r, ahead or astern), or that of the
    ``telegraph`` where that is not "remote": 0 for "stop", else a share of ``telegraph_speeds``,
    negative astern. With omega the speed of the shaft, positive ahead, and Q the ``load``, what
    the propeller takes:

        J omega' = M - Q - F sgn(omega)        F holds a shaft at rest up to |M - Q|
        M_w = K e + I,   I' = K e / T_i,   K = governor_gain M_r / n_r,   e = order n_r - omega

    M is M_w within these limits; I waits while they hold it, and starts anew after M = 0:

    - M drives to the side of the order alone, and not against a shaft that turns the other way
      faster than ``reversing_speed`` n_r: a two-stroke engine reverses by starting air at less than
      half of its speed, an astern turbine at any. Stopped, M = 0 and the propeller drives it.
    - |M| <= M_r (c + (1 - c) |omega| / n_r), M_r ``rated_torque`` and c ``torque_at_rest``: below
      1 of a diesel engine whose air is short at low speed (the torque and speed limit of MAN
      Energy Solutions, Basic principles of ship propulsion), 1 of an electric motor, about 2 of a
      steam turbine, which gives twice its torque at rest.
    - |M| grows by M_r in ``load_time`` at least; it falls at once.

    Over a step h the load is held, and M that of its beginning: exact for a constant M - Q. The
    shaft is stable with the propeller where h (K + dQ/domega) < 2 J; dQ/domega is about
    2 M_r / n_r. ``shaft_order`` is omega as a share of n_r, the ``propeller_speed`` of a ship.

    Failures are those of `Actuator`: no order arrives, and the engine stops; half of M is left; it
    loads ten times as slowly.

    Raises InputError in a step for another order of the telegraph.

    Not modelled: fuel, scavenging air and turbocharger, starting air that is used up, gears that
    slip, torsion of the shaft.
    """

    exercised: ClassVar = {"friction": 0.5, "telegraph": "half ahead"}

    rated_speed = Parameter(
        (10.0, 10.0), "rad/s", "n_r, shaft speed at orders 1 and -1, both positive",
        axes=("ahead", "astern"), min=1e-9,
    )  # fmt: skip
    rated_torque = Parameter(
        (10.0, 10.0), "N.m", "M_r, ahead and astern", axes=("ahead", "astern"), min=1e-9
    )
    torque_at_rest = Parameter(1.0, "1", "c, share of M_r with the shaft at rest", min=0.0)
    load_time = Parameter(0.0, "s", "least time from no load to M_r, 0 for none", min=0.0)
    reversing_speed = Parameter(
        1.0, "1", "share of n_r from which on M brakes a shaft that turns the other way", min=0.0
    )
    inertia = Parameter(1.0, "kg.m2", "J, of engine, shaft, propeller and its water", min=1e-9)
    friction = Parameter(0.0, "N.m", "F, of shaft and engine", min=0.0)
    governor_gain = Parameter(2.0, "1", "of M_r, for an error of n_r", min=0.0)
    governor_time = Parameter(2.0, "s", "T_i, of the governor's integral", min=1e-6)
    telegraph_speeds = Parameter(
        (0.35, 0.5, 0.65, 0.8), "1", "shares of n_r that the telegraph orders",
        axes=("dead_slow", "slow", "half", "full"), min=0.0, max=1.0,
    )  # fmt: skip

    command = Input("1", "share of n_r, -1 to 1, positive ahead", role="command")
    telegraph = Input(
        "1", f"one of {', '.join(ORDERS)}", type=str, start=REMOTE, choices=ORDERS, optional=True
    )
    load = Input("N.m", "Q, moment that the propeller takes, positive against a shaft ahead")

    shaft_order = Output("1", "shaft speed as a share of n_r, positive ahead")
    speed = Output("rad/s", "shaft speed, positive ahead")
    torque = Output("N.m", "M, positive ahead")
    power = Output("W", "M omega")

    def start(self, t: float) -> None:
        """Start with the shaft at rest, and no load."""
        self._speed = self._torque = self._integral = 0.0
        self.begin_at(0.0)

    def step(self, t: float, h: float) -> None:
        """Govern, and turn the shaft."""
        received = self.take(t, [self._ordered()], [-1.0], [1.0])
        order = 0.0 if received is None else min(max(received[0], -1.0), 1.0)
        self._torque = self.effect * self._governed(order, h)
        turned = self._speed + h * (self._torque - self.load) / self.inertia
        held = h * self.friction / self.inertia
        self._speed = math.copysign(max(abs(turned) - held, 0.0), turned)

    def outputs(self, t: float) -> None:
        """Publish the shaft's motion, and what drives it."""
        self.speed, self.torque = self._speed, self._torque
        self.shaft_order = self._share()
        self.power = self._torque * self._speed

    def _ordered(self) -> float:
        """Return the share of n_r that is ordered. Raises InputError for an unknown one."""
        if self.telegraph == REMOTE:
            return float(self.command)
        if self.telegraph == STOP:
            return 0.0
        for place in range(len(STEPS)):
            if self.telegraph == AHEAD[place]:
                return float(self.telegraph_speeds[place])
            if self.telegraph == ASTERN[place]:
                return -float(self.telegraph_speeds[place])
        raise InputError(f"{self.name}: {unknown('telegraph order', self.telegraph, ORDERS)}")

    def _governed(self, order: float, h: float) -> float:
        """Return M; the integral waits while M is limited, and starts anew after M = 0."""
        rated = self._of(self.rated_speed, order)
        error = order * rated - self._speed
        proportional = self.governor_gain * self._of(self.rated_torque, order) / rated * error
        integral = self._integral + proportional * h / self.governor_time
        wanted = proportional + integral
        torque = self._limited(order, wanted, h)
        if torque in (0.0, wanted):
            self._integral = integral if torque else 0.0
        return torque

    def _limited(self, order: float, wanted: float, h: float) -> float:
        """Return ``wanted`` within the limits of the engine."""
        side = math.copysign(1.0, order)
        ahead = side * self._share()
        if order == 0.0 or ahead < -self.reversing_speed:
            return 0.0
        most = self._of(self.rated_torque, order)
        share: float = self.torque_at_rest + (1.0 - self.torque_at_rest) * max(ahead, 0.0)
        if self.load_time > 0.0:
            loaded = max(side * self._torque, 0.0) / most
            share = min(share, loaded + h / (self.slowness * self.load_time))
        return side * min(max(side * wanted, 0.0), max(share, 0.0) * most)

    def _share(self) -> float:
        """Return omega as a share of n_r."""
        return float(self._speed / self._of(self.rated_speed, self._speed))

    def _of(self, values: tuple[float, float], side: float) -> float:
        """Return the value ahead, or that astern for a ``side`` below 0."""
        return float(values[0] if side >= 0.0 else values[1])
