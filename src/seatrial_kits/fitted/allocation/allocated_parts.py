"""Parts of a body as control allocation takes them: what each gives at most, and its limits."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from seatrial.errors import InputError
from seatrial.model.component import Parameter

from ..parts.lift import lift_slope
from ..parts.slots import COUNT, FOILS, PROPULSORS, FoilSlots, PropulsorSlots, read_kinds
from ..parts.steering import require_steering
from .part_wrenches import (
    AXES,
    Array,
    capacities,
    given_alone,
    lift_wrench,
    read_axes,
    thrust_wrench,
)

BY_SPEED = ("propeller", "wageningen-b", "four-quadrant", "jet")
"""Kinds whose order is a share of the shaft speed: at rest their thrust goes by its square."""
_NO_THRUST = tuple(PropulsorSlots.ports["propulsor_thrust_1"].start)
"""Value of a thrust that nobody gave; the craft needs none where coefficients give it."""
STEERING = ("fin", "linear-fin", "rudder")
"""Kinds of foils in the water."""
PRIORITIES = (1.0, 1.0, 30.0, 27e3, 27e3, 900.0)
"""Weights of the axes, each as a share of the largest force or moment there."""
_BUILT_IN = {
    "propulsor": "position axis thrust exponent fading_speed angle_limit turns_with",
    "foil": "position roll area aspect_ratio lift angle_limit",
}
"""Parameters of parts that say what there is to give: native code has what follows from them."""


class AllocatedParts(PropulsorSlots, FoilSlots):
    """Mix-in: wrenches at share 1 of propulsors and foils, a column each, rows by ``axes``.

    Share 1 of a propulsor is the larger of its thrusts ahead and astern, that of a foil its
    largest angle, per pascal of dynamic pressure.
    """

    structural: ClassVar = [
        f"{sort}_{name}_{number}"
        for sort, names in _BUILT_IN.items()
        for name in names.split()
        for number in range(1, COUNT + 1)
    ]
    tabulated: ClassVar = {
        "read_parts": (
            *("_kinds", "_leaders", "_turning", "_fixed", "_helms", "_on_helm", "_foils"),
            *("_ranges", "_first_angles", "_reaches", "_fading", "_exponents", "_most", "_rows"),
            *("_columns", "_along", "_abeam"),
        )
    }

    axes = Parameter(
        "", "1", f"axes that are asked for, some of {', '.join(AXES)}", check=read_axes
    )

    def read_parts(self) -> None:
        """Work out what each part gives; raises InputError for parts and axes that do not fit."""
        self._kinds = read_kinds(self.propulsors, "propulsor", PROPULSORS)
        count = len(self._kinds)
        self._leaders = require_steering(
            self.name, self.propulsor_turns_with[:count], self.propulsor_angle_limit[:count]
        )
        self._check_propulsors()
        thrusts = self.propulsor_thrust
        used = [number for number in range(len(self._kinds)) if max(thrusts[number]) > 0.0]
        self._turning = [number for number in used if self._turns(number)]
        self._fixed = [number for number in used if number not in self._turning]
        led_by = [self._leaders[number] for number in self._turning]
        self._helms = sorted(set(led_by))
        self._on_helm = [[i for i, one in enumerate(led_by) if one == h] for h in self._helms]
        self._foil_kinds = read_kinds(self.foils, "foil", FOILS)
        self._foils = [n for n, kind in enumerate(self._foil_kinds) if kind in STEERING]
        self._check_linear_fins()
        self._ranges = [(least, most) for least, most in self.propulsor_angle_limit]
        self._first_angles = [self._at_rest(number) for number in range(COUNT)]
        self._reaches = [_reach(*thrust) for thrust in thrusts]
        self._fading = [
            speed if kind == "tunnel" else 0.0
            for kind, speed in zip(self._kinds, self.propulsor_fading_speed, strict=False)
        ]
        by_speed = [kind in BY_SPEED for kind in self._kinds]
        exponents = zip(by_speed, self.propulsor_exponent, strict=False)
        self._exponents = [2.0 if squared else exponent for squared, exponent in exponents]
        self._most = list(self.foil_angle_limit)
        self._rows = sorted(read_axes(self.axes), key=lambda row: -PRIORITIES[row])
        fixed = [self._thrust(n, self._first_angles[n]) for n in self._fixed]
        fixed += [self._lift(number) for number in self._foils]
        along = [self._thrust(n, 0.0) for n in self._turning]
        abeam = [self._thrust(n, 0.5 * math.pi) for n in self._turning]
        self._check_axes([*fixed, *along, *abeam])
        asked = [[each[self._rows].tolist() for each in own] for own in (fixed, along, abeam)]
        self._columns, self._along, self._abeam = asked

    def order_of(self, number: int, share: float) -> float:
        """Return the order that gives a share of the larger thrust of a propulsor."""
        astern, ahead = self._reaches[number]
        side = ahead if share > 0.0 else astern
        if share == 0.0 or side == 0.0:
            return 0.0
        return math.copysign(min(abs(share) / side, 1.0) ** (1.0 / self._exponents[number]), share)

    def _check_propulsors(self) -> None:
        for number in range(len(self._kinds)):
            axis, (least, most) = self.propulsor_axis[number], self.propulsor_angle_limit[number]
            length = math.hypot(*axis)
            if abs(length - 1.0) > 1e-6:
                raise InputError(
                    f"{self.name}.propulsor_axis_{number + 1} is {axis}, of length {length:.6g}: "
                    "give a unit vector"
                )
            if least > most:
                raise InputError(
                    f"{self.name}.propulsor_angle_limit_{number + 1} is {least!r} to {most!r} rad: "
                    "it must rise"
                )
            if self._kinds[number] in BY_SPEED and self.propulsor_thrust[number] == _NO_THRUST:
                raise InputError(
                    f"{self.name}.propulsor_thrust_{number + 1} is not given: allocation to a "
                    f"{self._kinds[number]} takes its bollard thrust, N, ahead and astern"
                )
            if self._turns(number) and abs(axis[2]) > 1e-6:
                raise InputError(
                    f"{self.name}.propulsor_axis_{number + 1} is {axis}: a propulsor that turns "
                    "about z has a horizontal one"
                )

    def _check_linear_fins(self) -> None:
        for number, kind in enumerate(self._foil_kinds):
            if kind == "linear-fin" and not self.foil_lift[number] > 0.0:
                raise InputError(
                    f"{self.name}.foil_lift_{number + 1} is {self.foil_lift[number]!r}, of a "
                    "linear-fin: more than 0 is needed"
                )

    def _check_axes(self, wrenches: list[Array]) -> None:
        """Raise InputError unless the parts give each of ``axes`` without the others."""
        columns = np.stack(wrenches, axis=1) if wrenches else np.zeros((len(AXES), 0))
        rows = read_axes(self.axes)
        if columns.size and not rows:
            raise InputError(f"{self.name}.axes names none: give some of {', '.join(AXES)}")
        most = capacities(columns)
        there = np.flatnonzero(most > 1e-9 * most.max())
        for row, gives in zip(rows, given_alone(columns, rows), strict=True):
            if not gives:
                how = "only together with another one" if row in there else "not at all"
                raise InputError(
                    f"{self.name}.axes is {self.axes!r}, but its parts ("
                    f"{', '.join([*self._kinds, *self.foils.split()]) or 'none'}) give {AXES[row]} "
                    f"{how}: they give {', '.join(AXES[i] for i in there) or 'nothing'}"
                )

    def _turns(self, number: int) -> bool:
        """Return whether a propulsor turns, by itself or with another one."""
        least, most = self.propulsor_angle_limit[self._leaders[number]]
        return bool(least < most)

    def _at_rest(self, number: int) -> float:
        """Return the angle of a propulsor at the start: the one of its range nearest to 0."""
        leader = self._leaders[number] if number < len(self._kinds) else number
        least, most = self._ranges[leader]
        return float(min(max(0.0, least), most))

    def _thrust(self, number: int, angle: float) -> Array:
        """Return the wrench of a propulsor at share 1."""
        position, axis = self.propulsor_position[number], self.propulsor_axis[number]
        most: float = max(self.propulsor_thrust[number])
        return most * thrust_wrench(position, axis, angle)

    def _lift(self, number: int) -> Array:
        """Return the wrench of a foil at share 1, per pascal."""
        most: float = self.foil_area[number] * self._slope(number) * self.foil_angle_limit[number]
        return most * lift_wrench(self.foil_position[number], self.foil_roll[number])

    def _slope(self, number: int) -> float:
        """Return the lift coefficient of a foil by its angle, 1/rad."""
        own: float = self.foil_lift[number]
        is_linear = self._foil_kinds[number] == "linear-fin"
        return own if is_linear else float(lift_slope(self.foil_aspect_ratio[number]))


def _reach(ahead: float, astern: float) -> tuple[float, float]:
    """Return the largest thrusts astern and ahead as shares of the larger one."""
    most = max(ahead, astern)
    return (astern / most, ahead / most) if most > 0.0 else (0.0, 0.0)
