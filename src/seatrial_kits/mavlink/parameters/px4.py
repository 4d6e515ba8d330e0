"""Parameters of PX4 that ground stations look for."""

from __future__ import annotations

from ..settings import ALL_CHECKS, COMPASS_CHECK, Settings
from ..vehicle import Identity
from .definition import INT32, Definition, choice, fixed, real, whole
from .listed import px4_listed

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
