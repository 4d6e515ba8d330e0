"""Parameters of a vehicle, all together."""

from __future__ import annotations

from collections.abc import Collection

from seatrial.links.servos import read_servos

from ..settings import ALL_CHECKS, COMPASS_CHECK, Settings
from ..vehicle import Identity, Vehicle
from .ardupilot import ardupilot_parameters
from .definition import INT32, Definition, choice, fixed, real, whole
from .file import ParameterFile
from .listed import px4_listed
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


_ACTIONS = {0: "none", 1: "hold", 2: "return", 5: "disarm", 6: "disarm"}
_SUBMERGED_ACTIONS = {**_ACTIONS, 3: "surface"}
_FENCE_ACTIONS = {0: "none", 1: "none", 2: "hold", 3: "return", 4: "disarm"}
_SUBMERGED_FENCE_ACTIONS = {**_FENCE_ACTIONS, 5: "surface"}
_WITHOUT_POSITION = {0: ALL_CHECKS, 1: COMPASS_CHECK}


def px4_parameters(identity: Identity, settings: Settings) -> list[Definition]:
    """Return the parameters of a boat or a submarine.

    Those that lead to ``settings`` start with its values. The others say who the vehicle is, and
    that it is set up: these cannot be set. Raises InputError for a setting that PX4 has no
    number for.
    """
    actions = _SUBMERGED_ACTIONS if identity.submerged else _ACTIONS
    fence_actions = _SUBMERGED_FENCE_ACTIONS if identity.submerged else _FENCE_ACTIONS
    battery_actions = {0: "none", 2: "surface" if identity.submerged else "return"}
    return [
        fixed("MAV_SYS_ID", INT32, identity.system),
        fixed("MAV_COMP_ID", INT32, identity.component),
        fixed("MAV_TYPE", INT32, identity.vehicle_type),
        choice("NAV_DLL_ACT", "failsafe", settings, actions, INT32),
        whole("COM_DL_LOSS_T", "station_timeout", settings, 0, 2**31 - 1),
        real("COM_RC_LOSS_T", "manual_timeout", settings),
        real("COM_OF_LOSS_T", "target_timeout", settings),
        choice("COM_ARM_WO_GPS", "arming_check", settings, _WITHOUT_POSITION, INT32),
        choice("GF_ACTION", "fence_action", settings, fence_actions, INT32),
        choice("COM_LOW_BAT_ACT", "battery_action", settings, battery_actions, INT32),
        real("BAT_LOW_THR", "battery_low_charge", settings),
        real("NAV_LOITER_RAD", "loiter_radius", settings),
        real("NAV_ACC_RAD", "waypoint_radius", settings),
        real("GND_SPEED_TRIM", "cruise_speed", settings),
        *px4_listed(submerged=identity.submerged),
    ]
