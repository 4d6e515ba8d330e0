"""Control allocation of up to 16 fixed thrusters: force and moment to pulses."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ...errors import InputError
from ...model.component import Input, Output, Parameter, Terminal, terminal
from ...physics.thrust_curve import ThrustCurve
from ...physics.thrusters import COUNT, FixedThrusters
from .thruster_pulses import ThrusterPulses

_CHANNELS = tuple(f"ch{number}" for number in range(1, COUNT + 1))
_SURGE, _SWAY, _HEAVE, _ROLL, _PITCH, _YAW = range(6)
"""Rows of the thruster matrix."""

_BOW, _SIDE, _COS = 0.156, 0.111, 0.5**0.5
_EXERCISED = [
    ([_BOW, _SIDE, 0.085], [_COS, -_COS, 0]),
    ([_BOW, -_SIDE, 0.085], [_COS, _COS, 0]),
    ([-_BOW, _SIDE, 0.085], [-_COS, -_COS, 0]),
    ([-_BOW, -_SIDE, 0.085], [-_COS, _COS, 0]),
    ([0.12, 0.218, 0], [0, 0, -1]),
    ([0.12, -0.218, 0], [0, 0, -1]),
    ([-0.12, 0.218, 0], [0, 0, -1]),
    ([-0.12, -0.218, 0], [0, 0, -1]),
]


class ThrusterMatrixAllocation(FixedThrusters, ThrustCurve, ThrusterPulses):
    """Pulses of fixed thrusters that give a force (X, Y, Z) and a moment (K, M, N), as they can.

    Column i of the thruster matrix B is (d_i, r_i x d_i), as in `Propulsion`: give both the same
    positions and directions. The thrusts, N, are those of the pseudo-inverse B+,

        T = B+ (X, Y, Z, K, M, N),

    of all that give the demand those with the least sum of squares. K and M are 0 unless they are
    asked for: thrusters below the CG, which pitch the craft as they drive it, are balanced by the
    others. With ``moments`` = yaw the rows of roll and pitch are left out, and what is asked of
    them, for craft that cannot or need not balance them. A demand that no thrusts give, such as
    sway of a craft without thrusters abeam, is met with the least error in N and N.m.

    **Saturation.** No thruster goes beyond ``thrust_ahead`` or ``thrust_astern``. What the
    demand asks beyond is cut off in this order: roll and pitch moment, alike, get all that they
    can, then the yaw moment what is left, then heave, then surge and sway, alike, so that the
    force keeps its direction. Each part is its own T times the largest share from 0 to 1 that fits:

        T = s_KM T(K, M) + s_N T(N) + s_Z T(Z) + s_XY T(X, Y)

    Thruster i is on channel i, all are alike, and a thrust becomes a pulse as in
    `ThrusterPulses`, or with ``law`` = polynomial by the inverse of ``thrust_curve``, a share of
    the pulses' range, up to its first maximum; channels without a thruster stay at neutral. X
    ahead, Y to starboard, Z down positive, N; K starboard down, M bow up, N to starboard positive,
    N.m; body axes; pulses s. Static.

    Not modelled: motors with two leads swapped; turn their direction instead.

    Raises InputError at the start if the pulses do not rise, for a direction that is neither
    zero nor of length 1 within 1e-6, and for a polynomial that does not rise.
    """

    exercised: ClassVar = {
        f"{name}_{number}": value
        for number, vectors in enumerate(_EXERCISED, 1)
        for name, value in zip(("position", "direction"), vectors, strict=True)
    }

    structural: ClassVar = [
        "thrust_curve",
        *(f"{n}_{number}" for n in ("position", "direction") for number in range(1, COUNT + 1)),
    ]

    moments = Parameter(
        "all",
        "1",
        "moments that are allocated: all, roll and pitch at 0; or yaw alone",
        choices=("all", "yaw"),
    )
    law = Parameter(
        "power", "1", "form of the thrusts by the pulses", choices=("power", "polynomial")
    )

    surge = Input("N", "surge force wanted, positive ahead")
    sway = Input("N", "sway force wanted, positive to starboard")
    heave = Input("N", "heave force wanted, positive down")
    roll_moment = Input("N.m", "roll moment wanted, positive starboard down", optional=True)
    pitch_moment = Input("N.m", "pitch moment wanted, positive bow up", optional=True)
    yaw_moment = Input("N.m", "yaw moment wanted, positive to starboard")

    pulse = Output("s", "pulse to each thruster, by channel", axes=_CHANNELS, start=1.5e-3)

    _DEMAND = ("surge", "sway", "heave", "roll_moment", "pitch_moment", "yaw_moment")
    terminals: ClassVar = {
        "demand": terminal(*_DEMAND),
        "actuators": Terminal({channel: f"pulse.{channel}" for channel in _CHANNELS}),
    }

    def start(self, t: float) -> None:
        """Invert the thruster matrix; raises InputError as the class says."""
        self.check_pulses()
        if self.law == "polynomial" and not self.rises():
            raise InputError(
                f"{self.name}.thrust_curve is {list(self.thrust_curve)}, whose thrust falls from "
                "command 0 on: it must rise"
            )
        effects = {i: each for i, each in enumerate(self.effects()) if each is not None}
        self._channels = list(effects)
        rows = range(6) if self.moments == "all" else (_SURGE, _SWAY, _HEAVE, _YAW)
        matrix = np.array([[effect[row] for effect in effects.values()] for row in rows])
        inverse = np.linalg.pinv(matrix)
        self._per_newton = {row: inverse[:, at].tolist() for at, row in enumerate(rows)}

    def outputs(self, t: float) -> None:
        """Allocate."""
        given = [0.0] * len(self._channels)
        tilting = {_ROLL: self.roll_moment, _PITCH: self.pitch_moment}
        for demand in (
            tilting if self.moments == "all" else {},
            {_YAW: self.yaw_moment},
            {_HEAVE: self.heave},
            {_SURGE: self.surge, _SWAY: self.sway},
        ):
            given = self._with(given, self._thrusts(demand))
        pulses = [self.pulse_neutral] * COUNT
        for channel, thrust in zip(self._channels, given, strict=True):
            pulses[channel] = self.pulse_of(thrust)
        self.pulse = pulses

    def _away(self, thrust: float, full: float, span: float) -> float:
        if self.law == "power":
            return super()._away(thrust, full, span)
        return span * self.command_of(thrust)

    def _thrusts(self, demand: dict[int, float]) -> list[float]:
        """Return the thrusts of a demand, N or N.m by row, without limits."""
        return [
            sum(value * self._per_newton[row][i] for row, value in demand.items())
            for i in range(len(self._channels))
        ]

    def _with(self, given: list[float], more: list[float]) -> list[float]:
        """Return thrusts with the largest share of more that no thruster's limit forbids."""
        share = 1.0
        for thrust, added in zip(given, more, strict=True):
            limit = self.thrust_ahead if added > 0.0 else -self.thrust_astern
            if added:
                share = min(share, max((limit - thrust) / added, 0.0))
        return [thrust + share * added for thrust, added in zip(given, more, strict=True)]
