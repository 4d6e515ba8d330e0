"""Turning circle of the KVLCC2, after a minute straight ahead, at any instants.

The ship is that of `tests/reference/kvlcc2_full_turn_m35.csv`, 320 m long, at rows of 1 s; between
them are cubic splines. North and east are m from 45 deg north, 7 deg east.
"""

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from pymap3d import ned2geodetic
from scipy.interpolate import CubicSpline

FILE = Path(__file__).parents[2] / "reference/kvlcc2_full_turn_m35.csv"
APPROACH_S, TURN_S = 60, 420
END_S = APPROACH_S + TURN_S
"""Time of the last row."""
HOME = (45.0, 7.0)
SPEED, RATE = 7.974, 0.0118
"""Of the approach, m/s; the largest of the turn, rad/s."""
UNIX = 1_714_564_770.0
"""UNIX time of the first row: 2024-05-01T11:59:30Z."""


@dataclass(frozen=True)
class Motion:
    """Arrays (n,), SI, and latitude and longitude in deg."""

    time: np.ndarray
    north: np.ndarray
    east: np.ndarray
    heading: np.ndarray
    helm: np.ndarray
    latitude: np.ndarray
    longitude: np.ndarray


@cache
def _splines():
    rows = np.loadtxt(FILE, delimiter=",", skiprows=2)[: TURN_S + 1]
    before = np.arange(-APPROACH_S, 0.0)
    straight = np.zeros((APPROACH_S, rows.shape[1]))
    straight[:, 0], straight[:, 1] = before, SPEED * before
    rows = np.concatenate((straight, rows))
    time = rows[:, 0] + APPROACH_S
    north, east, heading = (CubicSpline(time, rows[:, k]) for k in (1, 2, 3))
    return north, east, heading, lambda at: np.interp(at, time, rows[:, 7])


def circle(period=1.0, offset=0.0):
    """Return the motion each period, from an offset on; s."""
    splines = _splines()
    at = np.arange(offset, END_S, period)
    north, east, heading, helm = (each(at) for each in splines)
    latitude, longitude, _ = ned2geodetic(north, east, 0.0, *HOME, 0.0)
    return Motion(at, north, east, heading, helm, latitude, longitude)


def degrees(angle):
    """Return an angle in degrees, from 0 up to 360."""
    return math.degrees(angle) % 360.0
