"""Estimator telemetry: which estimates are good, and how well the measurements fit them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..scaling import microseconds
from ..service import Service, builds
from ..transport import Transport
from ..vehicle import Vehicle

# The two messages have the same bits for what is known here.
_ATTITUDE = mavlink.EKF_ATTITUDE
_DEPTH = mavlink.EKF_POS_VERT_ABS | mavlink.EKF_VELOCITY_VERT
_POSITION = (
    mavlink.EKF_VELOCITY_HORIZ
    | mavlink.EKF_POS_HORIZ_REL
    | mavlink.EKF_POS_HORIZ_ABS
    | mavlink.EKF_PRED_POS_HORIZ_REL
    | mavlink.EKF_PRED_POS_HORIZ_ABS
)
_VELOCITY = mavlink.EKF_VELOCITY_HORIZ | mavlink.EKF_VELOCITY_VERT


class EstimatorTelemetry(Service):
    """EKF_STATUS_REPORT, of a PX4 ESTIMATOR_STATUS.

    Variances are ratios: how far a measurement is from what its rate predicts (`Innovation`), of
    the horizontal position by the velocity, of the height too, of the heading by the rates, and of
    the velocity itself. They grow while a sensor is lost, and when it scatters or jumps.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 1.0,
        mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 1.0,
    }

    def __init__(self, vehicle: Vehicle, transport: Transport) -> None:
        super().__init__(vehicle, transport)
        self._velocity, self._position = Innovation(2.0), Innovation(5.0)  # m/s, m
        self._height, self._heading = Innovation(2.0), Innovation(0.5, turns=True)  # m, rad

    def tick(self, now: float) -> None:
        """Take in the measurements."""
        e = self.vehicle.estimates
        north, east, down = e.position_n
        fixed, dives = e.position_valid, e.depth is not None
        self._position.update(now, (north, east), e.velocity_n[:2], valid=fixed)
        moves = fixed and "velocity" in e.connected
        self._velocity.update(now, e.velocity_n[:2], (0.0, 0.0), valid=moves)
        self._height.update(now, (down,), e.velocity_n[2:], valid=fixed or dives)
        self._heading.update(now, e.attitude[2:], e.rates[2:], valid=e.heading_valid)

    @property
    def _ratios(self) -> tuple[float, float, float, float]:
        found = (self._velocity, self._position, self._height, self._heading)
        velocity, position, height, heading = (round(each.ratio, 4) for each in found)
        return velocity, position, height, heading

    def _flags(self) -> int:
        e = self.vehicle.estimates
        surfaced = _DEPTH if e.position_valid or e.depth is not None else 0
        flags = (_ATTITUDE if e.tilt_valid and e.heading_valid else 0) | surfaced
        flags |= _POSITION if e.position_valid else mavlink.EKF_CONST_POS_MODE
        return int(flags if "velocity" in e.begun else flags & ~_VELOCITY)

    @builds(mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT)
    def _report(self, now: float) -> list[Message]:
        return [mavlink.MAVLink_ekf_status_report_message(self._flags(), *self._ratios, 0.0)]

    @builds(mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS)
    def _status(self, now: float) -> list[Message]:
        if not self.vehicle.dialect.main_and_sub:
            return []
        velocity, position, height, heading = self._ratios
        ratios = (velocity, position, height, heading, 0.0, 0.0)
        accuracy = (5.0 * position, 2.0 * height)  # m
        return [
            mavlink.MAVLink_estimator_status_message(
                microseconds(now), self._flags(), *ratios, *accuracy
            )
        ]


_SMOOTHING_S = 2.0
_LOST_S = 10.0
"""Time without a measurement after which its ratio is 1."""


class Innovation:
    """Ratio of the innovation to a ``gate``, smoothed; 1 and more is a measurement not to be used.

    While nothing valid comes the ratio grows by 1 each 10 s. ``turns`` is for angles, rad.
    """

    def __init__(self, gate: float, *, turns: bool = False) -> None:
        self._gate, self._turns = gate, turns
        self._last: tuple[float, ...] | None = None
        self._at = 0.0
        self.ratio = 0.0

    def update(
        self, now: float, value: Sequence[float], rate: Sequence[float], *, valid: bool
    ) -> None:
        """Take in what is measured at a simulated time, s, and its rate, 1/s."""
        if not valid:
            if self._last is None:
                self.ratio = min(self.ratio + (now - self._at) / _LOST_S, 2.0)
            self._last, self._at = None, now
            return
        if self._last is None:
            self._last, self._at = tuple(value), now
            return
        if tuple(value) == self._last:
            return  # not measured anew
        elapsed = now - self._at
        missed = (
            v - before - r * elapsed for v, before, r in zip(value, self._last, rate, strict=True)
        )
        found = math.hypot(*(math.remainder(x, math.tau) if self._turns else x for x in missed))
        share = 1.0 - math.exp(-elapsed / _SMOOTHING_S)
        self.ratio += share * (min(found / self._gate, 2.0) - self.ratio)
        self._last, self._at = tuple(value), now
