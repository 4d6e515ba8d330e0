"""Components that have the parameters of a vehicle file, outside of a rig."""

from __future__ import annotations

from ...errors import InputError, unknown
from ...fmi.direct import DirectInstance
from ...model.component import Component
from ...system.parameters import Vehicle
from ...system.references.values import from_entry, port_names, port_scalars


def parametrise(component: Component, vehicle: Vehicle, table: str, variant: str | None) -> None:
    """Set the parameters of a component to those of a vehicle's table; raises InputError."""
    if table not in vehicle.file.components:
        raise InputError(
            f"{vehicle.read_from.path}: a vehicle with a table {table!r} is needed, this one has "
            f"{', '.join(vehicle.file.components)}"
        )
    parameters = vehicle.parameter_set(table, variant)
    variables = DirectInstance(component).variables
    for name, entry in parameters.values.items():
        scalars = port_scalars(variables, name)
        if not scalars:
            known = port_names(variables)
            raise InputError(f"{parameters.origin}: {unknown('parameter', name, known)}")
        for scalar, given in from_entry(entry, scalars, f"{parameters.origin}: {name}").items():
            component.set(scalar, given.value)
    component.check_parameters()
