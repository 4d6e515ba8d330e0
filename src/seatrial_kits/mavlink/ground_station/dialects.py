"""Differences between firmwares, for a ground station that sends them on a mission."""

from __future__ import annotations

from dataclasses import dataclass

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import SimulationError

from ..codec import Message

_BOATS = (mavlink.MAV_TYPE_GROUND_ROVER, mavlink.MAV_TYPE_SURFACE_BOAT)
_COPTERS = (mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_TYPE_HEXAROTOR, mavlink.MAV_TYPE_OCTOROTOR)
_AUTO_ROVER, _AUTO_SUB, _DEPTH_HOLD = 10, 3, 2
_AUTO_COPTER, _GUIDED_COPTER = 3, 4
_PX4_MAIN_AUTO, _PX4_SUB_MISSION = 4, 4


@dataclass(frozen=True)
class Dialect:
    """One firmware's way to a mission."""

    mode: tuple[float, ...]
    """Of a mission: DO_SET_MODE's parameters after the first."""
    shown: int
    """The same as HEARTBEAT's custom_mode."""
    estimate: str
    """Message with the estimator's flags."""
    counts_home: bool
    """Whether item 0 is home."""
    arms_in: float | None = None
    """Mode in which it arms, where that is not the one it is in."""
    mode_first: bool = False
    """Whether it arms in the mission's mode, and starts it so."""
    takes_off: bool = False
    """Whether the first item after home takes it to the height of the first waypoint."""

    @property
    def before(self) -> int:
        """Number of items before the first waypoint."""
        return self.counts_home + self.takes_off


_ROVER = Dialect((_AUTO_ROVER,), _AUTO_ROVER, "EKF_STATUS_REPORT", counts_home=True)
_SUB = Dialect((_AUTO_SUB,), _AUTO_SUB, "EKF_STATUS_REPORT", counts_home=True, arms_in=_DEPTH_HOLD)
_COPTER = Dialect(
    (_AUTO_COPTER,),
    _AUTO_COPTER,
    "EKF_STATUS_REPORT",
    counts_home=True,
    arms_in=_GUIDED_COPTER,
    takes_off=True,
)
_PX4 = Dialect(
    (_PX4_MAIN_AUTO, _PX4_SUB_MISSION),
    _PX4_MAIN_AUTO << 16 | _PX4_SUB_MISSION << 24,
    "ESTIMATOR_STATUS",
    counts_home=False,
    mode_first=True,
)
DIALECTS = {
    **{(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, kind): _ROVER for kind in _BOATS},
    (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, mavlink.MAV_TYPE_SUBMARINE): _SUB,
    **{(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, kind): _COPTER for kind in _COPTERS},
    **{(mavlink.MAV_AUTOPILOT_PX4, kind): _PX4 for kind in _BOATS},
}
"""By MAV_AUTOPILOT and MAV_TYPE."""


def dialect_of(heartbeat: Message) -> Dialect:
    """Return how to talk to a vehicle. Raises SimulationError for one that takes no mission."""
    found = DIALECTS.get((heartbeat.autopilot, heartbeat.type))
    if found is None:
        ardupilot, px4 = (
            sorted(kind for autopilot, kind in DIALECTS if autopilot == each)
            for each in (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, mavlink.MAV_AUTOPILOT_PX4)
        )
        raise SimulationError(
            f"the vehicle is of MAV_TYPE {heartbeat.type} with MAV_AUTOPILOT "
            f"{heartbeat.autopilot}; missions are for rovers, boats, submarines and multirotors "
            f"{ardupilot} of ArduPilot ({mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA}), and for rovers and "
            f"boats {px4} of PX4 ({mavlink.MAV_AUTOPILOT_PX4})"
        )
    return found
