"""The best sail angle and flap of a smooth surface through the sail's table."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.interpolate import RectBivariateSpline

from seatrial.physics.foils import STEP, FoilTable

from .sail_search import Setting, setting

_FINE = math.radians(1.0)
_COARSE = math.radians(2.5)
_ROUNDS = 4


def smooth_setting(table: FoilTable, beta: float, least: float, most: float) -> Setting:
    """Return the setting with the greatest drive of the surfaces, and what the sail then gives.

    C_L and C_D are cubic splines in alpha and flap through the points of the table ([Silva2018],
    section 3.2, proposes an interpolation whose derivative is 0 where the drive is greatest). The
    maximum is looked for with ``least`` <= angle <= ``most``, rad, on a grid that narrows down
    four times, to 0.02 deg. The forces of the result are those of the sail, which is linear between
    the points (`sail_search.setting`).
    """
    lift, drag = _surfaces(table)
    s, c = math.sin(beta), math.cos(beta)
    angle, flap = 0.5 * (least + most), 0.5 * _flap_limit(table)
    across, along = 0.5 * (most - least), flap
    steps = max(2, math.ceil((most - least) / _FINE)), max(2, math.ceil(2 * along / _COARSE))
    for _ in range(_ROUNDS):
        angles = np.linspace(max(least, angle - across), min(most, angle + across), steps[0] + 1)
        flaps = np.linspace(
            max(0.0, flap - along), min(_flap_limit(table), flap + along), steps[1] + 1
        )
        alpha = np.remainder(beta - angles + 2.0 * math.pi, math.tau) - math.pi
        order = np.argsort(np.abs(alpha), kind="stable")
        sorted_alpha = np.abs(alpha)[order]
        c_l = lift(sorted_alpha, flaps) * np.sign(alpha)[order][:, None]
        drive = drag(sorted_alpha, flaps) * c - c_l * s
        row, column = np.unravel_index(int(np.argmax(drive)), drive.shape)
        angle, flap = float(angles[order[row]]), float(flaps[column])
        across, along = 2.0 * across / steps[0], 2.0 * along / steps[1]
        steps = 8, 8
    return setting(table, beta, angle, flap)


def _flap_limit(table: FoilTable) -> float:
    return (len(table.lift) - 1) * STEP


@cache
def _surfaces(table: FoilTable) -> tuple[RectBivariateSpline, RectBivariateSpline]:
    """Return C_L and C_D as splines over |alpha| and flap, rad."""
    alphas = np.arange(len(table.lift[0])) * STEP
    flaps = np.arange(len(table.lift)) * STEP
    lift, drag = (
        RectBivariateSpline(alphas, flaps, np.array(rows).T) for rows in (table.lift, table.drag)
    )
    return lift, drag
