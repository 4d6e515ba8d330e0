"""Parameters of a vehicle, all together."""

from __future__ import annotations

from collections.abc import Collection

from seatrial.links.servos import read_servos

from ..settings import Settings
from ..vehicle import Vehicle
from .ardupilot import ardupilot_parameters
from .file import ParameterFile
from .px4 import px4_parameters
from .simulated_faults import fault_parameters
from .simulation import simulation_parameters
from .table import ParameterTable
from .tunable import tunable_parameters, with_tunables


def vehicle_parameters(
    vehicle: Vehicle,
    settings: Settings,
    actuators: str = "",
    tunables: str = "",
    file: ParameterFile | None = None,
    failures: Collection[str] = (),
) -> ParameterTable:
    """Return the parameters of a vehicle: those of its kind, of the simulation, of the rig.

    ``failures`` are the units that can fail, ``actuators`` as in `read_servos`, ``tunables`` as in
    `tunable_parameters`. Raises InputError.
    """
    is_px4 = vehicle.dialect.name == "px4"
    if is_px4:
        definitions = px4_parameters(vehicle.identity, settings)
    else:
        definitions = ardupilot_parameters(vehicle.identity, settings, read_servos(actuators))
    definitions = [*definitions, *simulation_parameters(settings, is_px4=is_px4)]
    if not is_px4:
        definitions += fault_parameters(settings, failures)
    definitions = with_tunables(definitions, tunable_parameters(tunables), settings)
    return ParameterTable(definitions, settings, file)
