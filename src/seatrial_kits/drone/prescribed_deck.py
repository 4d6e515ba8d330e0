"""A deck whose motion in waves is given beforehand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from seatrial.model.component import Component, Noise, Output, Parameter, terminal
from seatrial.model.waypoints import NED
from seatrial.physics.craft.kinematics import cross, to_body, to_ned
from seatrial.physics.sea.waves import Waves

from .wave_follower import Follower, drawn, moved, period_of, read


class PrescribedDeck(Noise, Component):
    """Deck that follows the waves as a raft of ``size`` does, and that nothing pushes.

    Heave zeta, slopes s_n and s_e, surge x_n and x_e are sums over the components of a long-crested
    JONSWAP sea, averaged over the raft (`wave_follower`). With the pad at the height h over the
    origin, phi = -atan(s_e), theta = atan(s_n), psi = 0 and {n} north-east-down,

        pad = (x_n - h sin theta,  x_e + h sin phi,  -zeta - h cos theta cos phi)

    and the origin is below the pad along the deck's normal. The sea: significant height
    ``wave_height``, peak period ``wave_period`` (0: a steepness 2 pi Hs / (g Tp^2) of 0.04),
    ``wave_direction`` that the waves run to, from the bow; ``direction_by`` = "seed" draws it
    uniformly from 0 to pi. The seed draws direction, frequencies and phases. ``file``, a JSON
    file with the components, takes the place of all that.

    Not modelled: inertia of the raft, damping, drift, yaw, loads on the deck.
    """

    transient = Component.transient | {"_waves"}

    size = Parameter((1.168, 0.517, 0.043), "m", "length, breadth, draught", axes="xyz", min=0.0)
    pad_height = Parameter(0.2, "m", "height of the pad over the origin")
    wave_height = Parameter(0.0, "m", "significant wave height Hs; 0: a deck at rest", min=0.0)
    wave_period = Parameter(0.0, "s", "peak period; 0: that of a steepness of 0.04", min=0.0)
    wave_direction = Parameter(0.0, "rad", "direction that the waves run to, from the bow")
    direction_by = Parameter("value", "1", "where the direction is from", choices=("value", "seed"))
    file = Parameter("", "1", "JSON file of components; empty: they are drawn", role="file")

    position = Output("m", "origin of the deck in {n}", axes="xyz", frame="n")
    velocity = Output("m/s", "velocity of the origin, axes of the deck", axes="uvw")
    attitude = Output("rad", "Euler angles of the deck", axes=("phi", "theta", "psi"))
    rates = Output("rad/s", "angular velocity, axes of the deck", axes="pqr")
    pad_position = Output("m", "pad, {n}", axes=NED)
    pad_velocity = Output("m/s", "velocity of the pad, {n}", axes=NED)
    period = Output("s", "peak period of the sea")

    terminals: ClassVar = {"motion": terminal("position", "velocity", "attitude", "rates")}
    exercised: ClassVar = {"wave_height": 0.3, "wave_direction": 0.5}

    def start(self, t: float) -> None:
        """Draw the sea or read the file; raises InputError for a file that has none."""
        raft = read(Path(self.file), f"{self.name}.file") if self.file else self._drawn()
        self._waves: list[Sequence[float]] = []
        for each in raft.components:
            self._waves.append(each)
        self._period, self._height = raft.period, raft.pad_height

    def sea(self) -> Waves | None:
        """Return the waves that a started deck follows; None for a deck at rest."""
        waves = np.array(self._waves)
        omega, amplitude, phase, heave, _, _, north, east = waves.T
        towards = np.arctan2(east * heave, north * heave)  # surge has the sign of the heave
        return Waves(amplitude, omega, towards, phase) if amplitude.any() else None

    def _drawn(self) -> Follower:
        draw = self.generator(0)
        direction = math.pi * draw.random()
        if self.direction_by == "value":
            direction = self.wave_direction
        period = self.wave_period or period_of(self.wave_height) or 1.0
        return drawn(self.size, self.wave_height, period, direction, self.pad_height, draw)

    def outputs(self, t: float) -> None:
        """Publish the motion at ``t``."""
        values, changes = moved(self._waves, t)
        heave, s_n, s_e, x_n, x_e = values
        d_heave, d_sn, d_se, d_xn, d_xe = changes
        theta, phi, h = math.atan(s_n), -math.atan(s_e), self._height
        d_theta, d_phi = d_sn / (1.0 + s_n * s_n), -d_se / (1.0 + s_e * s_e)
        sp, cp, st, ct = math.sin(phi), math.cos(phi), math.sin(theta), math.cos(theta)
        pad = (x_n - h * st, x_e + h * sp, -heave - h * ct * cp)
        speed = (
            d_xn - h * ct * d_theta,
            d_xe + h * cp * d_phi,
            -d_heave + h * (st * cp * d_theta + ct * sp * d_phi),
        )
        attitude, rates = (phi, theta, 0.0), (d_phi, cp * d_theta, -sp * d_theta)
        up = (0.0, 0.0, -h)
        above, turned, own = to_ned(attitude, up), cross(rates, up), to_body(attitude, speed)
        self.position = [p - a for p, a in zip(pad, above, strict=True)]
        self.velocity = [v - w for v, w in zip(own, turned, strict=True)]
        self.attitude, self.rates = attitude, rates
        self.pad_position, self.pad_velocity, self.period = pad, speed, self._period
