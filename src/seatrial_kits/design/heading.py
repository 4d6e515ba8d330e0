"""Design of a heading autopilot by eigenvalues: poles of ship and PD control over the gain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.model.expressions import Vector
from seatrial.system.parameters import Vehicle, load_vehicle
from seatrial.trial.files.parametrised import parametrise
from seatrial_kits.ships.control.heading_autopilot import HeadingAutopilot
from seatrial_kits.ships.hulls.manoeuvring_ship import ManoeuvringShip

SHIP, AUTOPILOT = "manoeuvring-ship", "heading-autopilot"
GAINS = np.geomspace(1e-5, 1e2, 1401)
"""Gains K that are looked at, 200 a decade."""


@dataclass(frozen=True)
class Gain:
    """A gain that is singled out, and where its poles are."""

    K: float
    poles: Vector
    """Of the closed loop, in units of U / L."""


@dataclass(frozen=True)
class Locus:
    """The poles for one derivative time, over the gain."""

    derivative_time: float
    """T_d, in units of L / U."""
    poles: Vector
    """(gains, 3), in units of U / L; rows of `GAINS`."""
    wanted: list[Gain]
    """Where the least damping ratio is the one that was asked for."""
    limits: list[Gain]
    """Where the loop becomes unstable, or stable again."""
    stable_at_first: bool
    """Whether the loop is stable at the least of `GAINS`."""


@dataclass(frozen=True)
class HeadingDesign:
    """What root loci of a ship's heading control show."""

    vehicle: str
    variant: str | None
    time_unit: float
    """L / U, s."""
    A: Vector
    """(2, 2): A* of v, r."""
    B: Vector
    """(2,): B* of v, r."""
    damping_ratio: float
    loci: list[Locus]


def design_heading(
    name: str,
    variant: str | None = None,
    derivative_times: Sequence[float] | None = None,
    damping_ratio: float = np.sqrt(0.5),
    relative_to: Path | None = None,
) -> HeadingDesign:
    """Return the root loci of the vehicle ``name`` under delta = K (e + T_d e').

    [Moro1979], sections 3 and 4. The ship is the vehicle's `ManoeuvringShip`, linear or
    linearised on a straight course at its service speed. ``derivative_times`` are in units of
    L / U; None takes 0 and that of the vehicle's own autopilot.

    Raises InputError for bad input, and if the vehicle is not steered by a rudder.
    """
    if not 0.0 < damping_ratio < 1.0:
        raise InputError(f"damping ratio is {damping_ratio!r}, between 0 and 1 is needed")
    vehicle = load_vehicle(name, relative_to)
    ship = _ship(vehicle, variant)
    time_unit = ship.length / ship.speed
    A, B = dimensionless(ship)
    if derivative_times is None:
        derivative_times = [0.0, *_own_derivative_time(vehicle, variant, time_unit)]
    return HeadingDesign(
        vehicle=vehicle.read_from.name,
        variant=variant or vehicle.file.default,
        time_unit=time_unit,
        A=A,
        B=B,
        damping_ratio=damping_ratio,
        loci=[locus(A, B, T_d, damping_ratio) for T_d in derivative_times],
    )


def dimensionless(ship: ManoeuvringShip) -> tuple[Vector, Vector]:
    """Return A* (2, 2) and B* (2,) of sway and yaw on a straight course at service speed."""
    straight = np.array([0.0, 0.0, 0.0, ship.speed, 0.0, 0.0])
    linear = ship.linearise(straight)
    time_unit = ship.length / ship.speed
    scale = np.array([ship.speed, 1.0 / time_unit])
    A = time_unit * linear.A[4:, 4:] * scale / scale[:, None]
    return A, time_unit * linear.B[4:, linear.u_names.index("rudder")] / scale


def closed_loop(A: Vector, B: Vector, K: float, T_d: float) -> Vector:
    """Return the matrix (3, 3) of (v, r, psi) under delta = K psi + K T_d r: [Moro1979], eq. II."""
    return np.array(
        [
            [A[0, 0], A[0, 1] + K * T_d * B[0], K * B[0]],
            [A[1, 0], A[1, 1] + K * T_d * B[1], K * B[1]],
            [0.0, 1.0, 0.0],
        ]
    )


def least_damping(poles: Vector) -> float:
    """Return the least damping ratio -Re s / |s| of some poles."""
    return float(np.min(-poles.real / np.abs(poles)))


def locus(A: Vector, B: Vector, T_d: float, damping_ratio: float) -> Locus:
    """Return the poles over the gain, and the gains at which something happens."""

    def poles(K: float) -> Any:
        return np.linalg.eigvals(closed_loop(A, B, K, T_d))

    def gains(zeta: float) -> list[Gain]:
        found = _roots(lambda K: least_damping(poles(K)) - zeta)
        return [Gain(K, np.sort_complex(poles(K))) for K in found]

    over_gain = np.array([np.sort_complex(poles(K)) for K in GAINS])
    stable_at_first = bool(over_gain[0].real.max() < 0.0)
    return Locus(T_d, over_gain, gains(damping_ratio), gains(0.0), stable_at_first)


def _roots(function: Callable[[float], float]) -> list[float]:
    """Return where a function of the gain changes its sign, to the last digits."""
    from scipy.optimize import brentq

    values = [function(K) for K in GAINS]
    return [
        float(brentq(function, a, b, xtol=1e-15, rtol=1e-14))
        for (a, f), (b, g) in pairwise(zip(GAINS, values, strict=True))
        if f * g < 0.0
    ]


def _ship(vehicle: Vehicle, variant: str | None) -> ManoeuvringShip:
    ship = ManoeuvringShip(vehicle.read_from.name)
    parametrise(ship, vehicle, SHIP, variant)
    return ship


def _own_derivative_time(vehicle: Vehicle, variant: str | None, time_unit: float) -> list[float]:
    if AUTOPILOT not in vehicle.file.components:
        return []
    autopilot = HeadingAutopilot()
    parametrise(autopilot, vehicle, AUTOPILOT, variant)
    return [autopilot.derivative_gain / autopilot.proportional_gain / time_unit]
