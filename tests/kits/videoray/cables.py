"""Cables that the tests of the tether share, and closed forms of their shapes."""

import math

import numpy as np

from seatrial_kits.videoray.cable.cable import Cable

STILL = np.zeros((3, 1))
STREAM = np.array([[0.5], [0.0], [0.0]])
END_FORCE = np.array([3.0, 0.0, 10.0])
DIAMETER = 8.18e-3
NEUTRAL = 1000.0 * math.pi / 4.0 * DIAMETER**2


def cable(segments, **changes):
    """Return the tether of 40 m that is neutral in fresh water, without friction along it."""
    values = {
        "length": 40.0,
        "segments": segments,
        "diameter": DIAMETER,
        "mass_per_length": NEUTRAL,
        "axial_stiffness": 2e4,
        "damping_ratio": 0.2,
        "normal_drag": 1.2,
        "tangential_drag": 0.0,
        "added_mass": 1.0,
        "density": 1000.0,
        "gravity": 9.81,
    }
    return Cable(**values | changes)


def arc_in_current(segments):
    """Return nodes (3, N + 1) of the elastic neutral cable in STREAM under END_FORCE, exactly."""
    pull = math.hypot(3.0, 10.0)
    b = 0.5 * 1000.0 * DIAMETER * 1.2 * 0.5**2 / pull
    sigma = np.linspace(40.0, 0.0, segments + 1) * (1.0 + pull / 2e4)  # from the free end
    x = np.sqrt(1.0 + (0.3 + b * sigma) ** 2) / b
    z = np.arcsinh(0.3 + b * sigma) / b
    return np.array([x[0] - x, np.zeros_like(x), z[0] - z])


def catenary(segments, weight, horizontal, vertical):
    """Return nodes (3, N + 1) of an elastic catenary from its upper end, of 40 m, EA = 2e4 N.

    ``weight`` N/m, downwards; tension at the top (``horizontal``, ``vertical``), N, both pulling
    away from the top into the cable: northwards and down.
    """
    s = np.linspace(0.0, 40.0, segments + 1)
    H, V, w = horizontal, -vertical, weight
    start = V / H
    x = H * s / 2e4 + H / w * (np.arcsinh((V + w * s) / H) - np.arcsinh(start))
    up = (V * s + w * s**2 / 2) / 2e4
    up += H / w * (np.sqrt(1 + ((V + w * s) / H) ** 2) - np.sqrt(1 + start**2))
    return np.array([x, np.zeros_like(x), -up])
