"""Craft of a vehicle: its own equations and numbers, as an identification changes them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.fmi.direct import DirectInstance
from seatrial.model.expressions import Model, Vector
from seatrial.model.plant import Plant
from seatrial.model.ports import Parameter
from seatrial.system.parameters import load_vehicle
from seatrial.system.part import Part
from seatrial.system.system import System

MOTION = {
    "north": ("position.x", "eta.x"),
    "east": ("position.y", "eta.y"),
    "depth": ("position.z",),
    "roll": ("attitude.phi",),
    "pitch": ("attitude.theta",),
    "heading": ("attitude.psi", "eta.psi"),
    "u": ("velocity.u", "nu.u"),
    "v": ("velocity.v", "nu.v"),
    "r": ("rates.r", "nu.r"),
}
"""States of the motion, as craft in six and in three degrees of freedom call them."""


@dataclass(frozen=True)
class Craft:
    """Equations of a vehicle's craft, and the numbers of its file."""

    name: str
    """Component in the vehicle's rig, by path."""
    kind: str
    """Name of the component."""
    plant: Plant
    parameters: dict[str, float]
    """All real ones by scalar name, SI, in the order in which the equations take them."""
    start: Vector
    """State (n,) that it starts from."""
    fed: tuple[str, ...]
    """Inputs that the vehicle's rig feeds, by scalar name."""
    source: tuple[Path, str]
    """The vehicle's file, and the table in it."""
    variant: str | None
    """Variant of the vehicle's file that the numbers are of."""

    @property
    def model(self) -> Model:
        """The compiled equations."""
        return self.plant.compiled()

    def place(self, motion: str) -> int | None:
        """Return which state a name of `MOTION` is, None for one that the craft does not have."""
        names = self.model.x_names
        return next((names.index(each) for each in MOTION[motion] if each in names), None)

    def places(self, motions: Sequence[str]) -> list[int]:
        """Return which states are names of `MOTION` that every craft has."""
        found = [self.place(motion) for motion in motions]
        return [place for place in found if place is not None]

    def free(self, named: list[str]) -> tuple[str, ...]:
        """Return the parameters to be identified: those named, else the kind's `CANDIDATES`.

        A whole port stands for its scalars. Candidates that are 0 in the file, or that the
        equations of the variant do not have, are left out. Raises InputError for a name that the
        craft does not have, for one that is named and is 0, which leaves no scale, or does not
        act, and for a craft without candidates.
        """
        acting = self._acting()
        if not named:
            usual = CANDIDATES.get(self.kind, ())
            found = tuple(name for name in usual if name in acting and self.parameters[name])
            if not found:
                raise InputError(
                    f"{self.source[0]}: {self.kind} has no usual parameters to identify: name "
                    f"some with --free; known: {', '.join(self.parameters)}"
                )
            return found
        names = [scalar for each in named for scalar in self._scalars(each)]
        for name in names:
            if name not in acting:
                raise InputError(f"--free: {name} does not act in the equations of {self.name}")
            if not self.parameters[name]:
                raise InputError(
                    f"--free: {name} is 0 in {self.source[0]}: an estimate other than 0 is needed "
                    "there to start from"
                )
        return tuple(dict.fromkeys(names))

    def unit(self, name: str) -> str:
        """Return the unit of a parameter or an input."""
        return self.plant.scalar_by_name[name].unit

    def limits(self, name: str) -> tuple[float, float]:
        """Return the least and the greatest value that a parameter may have."""
        scalar = self.plant.scalar_by_name[name]
        assert isinstance(scalar.port, Parameter)
        limits = (scalar.port.min, scalar.port.max)
        low, high = (each[scalar.index] if isinstance(each, tuple) else each for each in limits)
        return -math.inf if low is None else low, math.inf if high is None else high

    def _acting(self) -> set[str]:
        """Return the parameters that the derivatives depend on."""
        _, columns = self.model.rhs.jac_sparsity(0, 2).get_triplet()
        names = list(self.parameters)
        return {names[column] for column in columns}

    def _scalars(self, name: str) -> tuple[str, ...]:
        ports = {port.name: port for port in self.plant.parameter_ports}
        if name in ports:
            return tuple(ports[name].scalar_names)
        if name not in self.parameters:
            raise InputError(f"--free: {unknown('parameter', name, [*ports, *self.parameters])}")
        return (name,)


def craft_in(system: System) -> Craft:
    """Return the craft of a vehicle's rig that has been started, inside a system.

    Raises InputError for a vehicle whose motion is no single craft with equations of its own.
    """
    parts = [part for part in system.parts.values() if _is_craft(part)]
    where = system.rig.read_from.path
    if len(parts) != 1:
        found = ", ".join(part.name for part in parts) or "none"
        raise InputError(f"{where}: a vehicle of one craft with equations is needed, found {found}")
    (part,) = parts
    if part.vehicle is None:
        raise InputError(f"{where}: {part.name} takes no parameters of a vehicle's file")
    plant = _plant(part)
    ports = {port.name for port in plant.parameter_ports}
    names = [scalar.name for scalar in plant.scalars if scalar.port.name in ports]
    fed = {c.target[1] for c in system.connections if c.target[0] == part.name}
    return Craft(
        part.name,
        part.fmu,
        plant,
        {name: float(plant.get(name)) for name in names},
        np.array([plant.get(name) for name in plant.compiled().x_names]),
        tuple(name for name in plant.compiled().u_names if name in fed),
        part.vehicle,
        _variant(system, part.name, part.vehicle[0]),
    )


def _variant(system: System, name: str, path: Path) -> str | None:
    file = load_vehicle(str(path)).file
    if system.variant in file.variants:
        return system.variant
    return system.rig.components[name].scope.variant or file.default


def _is_craft(part: Part) -> bool:
    instance = part.instance
    if not (isinstance(instance, DirectInstance) and isinstance(instance.component, Plant)):
        return False
    return {"position.x", "attitude.psi"} <= set(instance.component.scalar_by_name)


def _plant(part: Part) -> Plant:
    assert isinstance(part.instance, DirectInstance)
    assert isinstance(part.instance.component, Plant)
    return part.instance.component


_SIX_DOF = (
    *("linear_damping_force.u", "quadratic_damping_force.u", "added_mass.xx"),
    *("linear_damping_force.v", "quadratic_damping_force.v", "added_mass.yy"),
    *("linear_damping_moment.r", "quadratic_damping_moment.r", "added_inertia.zz"),
    "crossflow_coefficient",
)
CANDIDATES: Mapping[str, tuple[str, ...]] = {
    "marine-craft": _SIX_DOF,
    "fitted-craft": (*_SIX_DOF, "body_lift_drag", "body_lift_efficiency", "foil_lift_1"),
    "mmg-ship": (
        *("resistance", "added_mass.x", "added_mass.y", "added_inertia"),
        *("X.vv", "X.rr"),
        *("Y.v", "Y.r", "Y.vvv", "Y.vvr", "Y.vrr"),
        *("N.v", "N.r", "N.vvv", "N.vvr", "N.vrr"),
    ),
    "manoeuvring-ship": (
        *("state_matrix.vv", "state_matrix.vr", "state_matrix.rv", "state_matrix.rr"),
        *("rudder_vector.v", "rudder_vector.r"),
        *("X.u", "X.vv", "X.rv", "X.dd"),
        *("Y.v", "Y.r", "Y.vvv", "Y.vvr", "Y.d"),
        *("N.v", "N.r", "N.vvv", "N.vvr", "N.d"),
    ),
}
"""Scalars of a craft's parameters by the name of its component."""
