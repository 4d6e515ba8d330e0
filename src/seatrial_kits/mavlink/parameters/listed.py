"""Parameters that ground stations read to know that a vehicle is set up, and that never change."""

from __future__ import annotations

from collections.abc import Mapping

from .definition import INT8, INT16, INT32, REAL32, Definition, fixed

Listed = Mapping[str, float]
"""Values by name: whole numbers of the type that the table has for them, and real ones."""

_TRUE_NORTH = "the vehicle is given its true heading"
_CALIBRATED = "simulated sensors need no calibration: their errors belong to the trial"
_NOT_THERE = "this vehicle has nothing of that kind"

# QGroundControl takes offsets of 0 for sensors that were never calibrated.
_CALIBRATION: Listed = {
    "INS_ACCOFFS_X": 0.001,
    "INS_ACCOFFS_Y": 0.001,
    "INS_ACCOFFS_Z": 0.001,
    "INS_ACCSCAL_X": 1.0,
    "INS_ACCSCAL_Y": 1.0,
    "INS_ACCSCAL_Z": 1.0,
    "INS_GYROFFS_X": 0.0,
    "INS_GYROFFS_Y": 0.0,
    "INS_GYROFFS_Z": 0.0,
    "INS_ACC_ID": 1,
    "INS_GYR_ID": 1,
}
_COMPASS: Listed = {
    "COMPASS_ENABLE": 1,
    "COMPASS_USE": 1,
    "COMPASS_USE2": 0,
    "COMPASS_USE3": 0,
    "COMPASS_DEV_ID": 1,
    "COMPASS_DEV_ID2": 0,
    "COMPASS_DEV_ID3": 0,
    "COMPASS_DEC": 0.0,
    "COMPASS_OFS_X": 1.0,
    "COMPASS_OFS_Y": 1.0,
    "COMPASS_OFS_Z": 1.0,
}
_ROVER_ABSENT: Listed = {"FS_THR_VALUE": 910, "FS_CRASH_CHECK": 0}
_SUB_ABSENT: Listed = {
    "FS_LEAK_ENABLE": 0,
    "FS_EKF_ACTION": 0,
    "FS_EKF_THRESH": 0.8,
    "FS_PRESS_ENABLE": 0,
    "FS_PRESS_MAX": 105000,
    "FS_TEMP_ENABLE": 0,
    "FS_TEMP_MAX": 62,
    "LEAK1_PIN": -1,
    "LEAK1_LOGIC": 0,
}
# COM_RC_IN_MODE 1: the vehicle is steered over the link, so no radio need be calibrated.
_PX4_SETUP: Listed = {
    "SYS_AUTOCONFIG": 0,
    "SYS_HITL": 0,
    "COM_RC_IN_MODE": 1,
    "CAL_ACC0_ID": 1,
    "CAL_GYRO0_ID": 1,
    "CAL_MAG0_ID": 1,
}
# PX4's numbers of a generic ground vehicle and a generic vectored underwater vehicle.
_PX4_AIRFRAMES = {False: 50000, True: 60000}


def ardupilot_listed(*, submerged: bool) -> list[Definition]:
    """Return the parameters that say that Rover or Sub is set up."""
    absent = _SUB_ABSENT if submerged else _ROVER_ABSENT
    return [
        *_fixed(_CALIBRATION, _CALIBRATED),
        *_fixed(_COMPASS, _TRUE_NORTH),
        *_fixed(absent, _NOT_THERE),
    ]


def px4_listed(*, submerged: bool) -> list[Definition]:
    """Return the parameters that say that a PX4 is set up."""
    airframe: Listed = {"SYS_AUTOSTART": _PX4_AIRFRAMES[submerged]}
    return [
        fixed(name, INT32, value, _CALIBRATED) for name, value in {**airframe, **_PX4_SETUP}.items()
    ]


def _fixed(listed: Listed, why: str) -> list[Definition]:
    return [fixed(name, _kind(value), value, why) for name, value in listed.items()]


def _kind(value: float) -> int:
    if isinstance(value, float):
        return REAL32
    return INT8 if -128 <= value < 128 else INT16 if -32768 <= value < 32768 else INT32
