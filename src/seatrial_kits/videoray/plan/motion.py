"""Planning of a vessel's motion: from wanted speeds to trajectory and commands."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError
from seatrial.model.expressions import Vector
from seatrial.system.parameters import load_vehicle
from seatrial.trial.files.parametrised import parametrise

from ..tracking.nominal_trajectory import NominalTrajectory
from ..tracking.vessel_nominal import Nominal, Profile, VesselModel, nominal_motion

VESSEL = "surface-vessel"
AXES = ("surge", "yaw")
PERIOD = 0.1
"""Time between the rows of a plan, s."""
_SHORTEST, _LONGEST = 1.0, 10_000.0
_AFTERWARDS = 60.0
"""How long a plan goes on after its speeds are reached, s, unless an end is given."""


@dataclass(frozen=True)
class MotionPlan:
    """The motion that wanted speeds lead to, every `PERIOD`, SI; x north, y east, psi clockwise."""

    vehicle: str
    variant: str | None
    surge: Profile
    yaw: Profile
    limit: float
    """Largest command that a thruster may get."""
    duration_was_found: bool
    time: Vector
    velocity: Vector
    """(rows, 3): U, V, R."""
    command: Vector
    """(rows, 2): t1, t2."""
    track: Vector
    """(rows, 3): x, y, psi, from the origin, heading north."""
    flat: Vector
    """(rows,): l U m11 - R m33, kg.m2/s, by which commands reach sway."""

    @property
    def peak(self) -> float:
        """The largest command of either thruster, at the rows."""
        return float(np.abs(self.command).max())

    @property
    def duration(self) -> float:
        """How long the speeds rise, s."""
        return max(self.surge.duration, self.yaw.duration)

    @property
    def feasible(self) -> bool:
        """Whether no command is beyond the limit."""
        return self.peak <= self.limit

    @property
    def flat_until(self) -> float | None:
        """When l U m11 - R m33 is 0 or changes its sign first, s; None if it never does."""
        against = np.flatnonzero(self.flat * self.flat[0] <= 0.0)
        return float(self.time[against[0]]) if len(against) else None


def plan_motion(
    name: str,
    surge: float,
    yaw_rate: float,
    *,
    variant: str | None = None,
    constant: Collection[str] = (),
    duration: float | None = None,
    stop: float | None = None,
    limit: float = 1.0,
    relative_to: Path | None = None,
) -> MotionPlan:
    """Return the motion of a vehicle that ends with ``surge``, m/s, and ``yaw_rate``, rad/s.

    [Paulino2015], section 4.1, for the vessel of 5.18: U and R are planned, each as a polynomial
    from rest within ``duration``, s, or, of `AXES` in ``constant``, as there from the start; sway
    and commands follow from the model (6.1 to 6.3, corrected, see `nominal_motion`). Without a
    duration it is the shortest in which no thruster gets more than ``limit``. The track is theirs:

        x' = U cos psi - V sin psi,   y' = U sin psi + V cos psi,   psi' = R

    Raises InputError for bad input, a vehicle without `SurfaceVessel`, and if no duration up to
    10,000 s is long enough.
    """
    _check(duration, stop, limit, constant)
    vehicle = load_vehicle(name, relative_to)
    nominal = NominalTrajectory("plan")
    parametrise(nominal, vehicle, VESSEL, variant)
    model = nominal.vessel()

    def profiles(duration: float) -> tuple[Profile, Profile]:
        return (
            Profile(surge, 0.0 if "surge" in constant else duration),
            Profile(yaw_rate, 0.0 if "yaw" in constant else duration),
        )

    found = duration is None and set(constant) != set(AXES)
    if found:
        duration = _shortest(model, profiles, limit)
    planned = profiles(duration or 0.0)
    rows = nominal_motion(model, *planned, PERIOD)
    end = (duration or 0.0) + _AFTERWARDS if stop is None else stop
    time: Vector = PERIOD * np.arange(round(end / PERIOD) + 1, dtype=np.float64)
    rows = [rows[min(k, len(rows) - 1)] for k in range(len(time))]
    velocity = np.array([row.velocity for row in rows])
    m11, _m22, m33 = model.mass
    return MotionPlan(
        vehicle=vehicle.read_from.name,
        variant=variant or vehicle.file.default,
        surge=planned[0],
        yaw=planned[1],
        limit=limit,
        duration_was_found=found,
        time=time,
        velocity=velocity,
        command=np.array([row.command for row in rows]),
        track=_track(velocity),
        flat=model.lever_arm * velocity[:, 0] * m11 - velocity[:, 2] * m33,
    )


def _check(
    duration: float | None, stop: float | None, limit: float, constant: Collection[str]
) -> None:
    for what, value in (("duration", duration), ("stop", stop)):
        if value is not None and not 0.0 < value <= _LONGEST:
            raise InputError(f"{what} is {value:g} s, allowed is more than 0 up to {_LONGEST:g} s")
    if not 0.0 < limit <= 1.0:
        raise InputError(f"limit is {limit:g}, allowed is more than 0 up to 1")
    for axis in constant:
        if axis not in AXES:
            raise InputError(f"constant is {axis!r}, allowed are {', '.join(AXES)}")
    if set(constant) == set(AXES) and duration is not None:
        raise InputError("speeds that are both there from the start have no duration")


def _peak(rows: list[Nominal]) -> float:
    return max(abs(share) for row in rows for share in row.command)


def _shortest(
    model: VesselModel, profiles: Callable[[float], tuple[Profile, Profile]], limit: float
) -> float:
    """Return the shortest duration within the limit, to a thousandth, not below 1 s."""

    def peak(duration: float) -> float:
        return _peak(nominal_motion(model, *profiles(duration), PERIOD))

    surge, yaw = (Profile(each.value, 0.0) for each in profiles(0.0))
    steady = _peak(nominal_motion(model, surge, yaw, PERIOD))
    if steady > limit:
        raise InputError(
            f"these speeds need {steady:.4g} of a thruster's thrust when they are reached, "
            f"allowed is {limit:g}: no duration is long enough"
        )
    high = _SHORTEST
    while peak(high) > limit:
        if high >= _LONGEST:
            raise InputError(
                f"no duration up to {_LONGEST:g} s keeps the commands within {limit:g}"
            )
        high = min(2.0 * high, _LONGEST)
    low = high / 2.0 if high > _SHORTEST else high
    while high - low > 1e-3 * high:
        middle = (low + high) / 2.0
        low, high = (low, middle) if peak(middle) <= limit else (middle, high)
    return high


def _track(velocity: Vector) -> Vector:
    """Return x, y, psi by Simpson's rule."""
    from scipy.integrate import cumulative_simpson

    u, v, r = velocity.T
    psi = cumulative_simpson(r, dx=PERIOD, initial=0.0)
    north = u * np.cos(psi) - v * np.sin(psi)
    east = u * np.sin(psi) + v * np.cos(psi)
    x, y = (cumulative_simpson(part, dx=PERIOD, initial=0.0) for part in (north, east))
    return np.column_stack((x, y, psi))
