"""Settings that change how the vehicle acts while it runs: parameters lead here."""

from __future__ import annotations

from dataclasses import dataclass, field

ALL_CHECKS, COMPASS_CHECK, GPS_CHECK = 1 << 0, 1 << 2, 1 << 3
"""Bits of `Settings.arming_check`, as ArduPilot's ARMING_CHECK has them."""
FASTEST = 100.0
"""Greatest speed that an order may name, m/s, as ArduPilot documents it for CRUISE_SPEED."""
_DAY = 86_400.0
LIMITS = {
    "station_timeout": (0.0, _DAY),
    "manual_timeout": (0.0, _DAY),
    "target_timeout": (0.0, _DAY),
    "full_speed": (0.0, FASTEST),
    "cruise_speed": (0.0, FASTEST),
    "waypoint_speed": (0.0, FASTEST),
    "waypoint_radius": (0.0, 1e4),
    "loiter_radius": (0.1, 1e4),
    "fence_depth": (0.0, 1.2e4),
    "battery_low_voltage": (0.0, 1e3),
    "battery_low_charge": (0.0, 1.0),
}
"""Least and greatest value of settings that are numbers, wherever they come from; SI."""


@dataclass
class Settings:
    """Settings of one vehicle. Services read them when they need them and keep no copies.

    SI. The values given at the start are the defaults of the parameters that lead here.
    """

    failsafe: str = "hold"
    station_timeout: float = 5.0
    manual_timeout: float = 3.0
    target_timeout: float = 3.0
    full_speed: float = 1.0
    """Speed of full thrust in SET_ATTITUDE_TARGET, m/s."""
    cruise_speed: float = 1.0
    waypoint_speed: float = 0.0
    """Speed to waypoints, m/s; 0 is the cruise speed."""
    waypoint_radius: float = 3.0
    """Distance at which a waypoint is reached, m."""
    loiter_radius: float = 10.0
    """Radius of turns that name none, m."""
    fence_action: str = "hold"
    """What it does outside its fence: one of the actions of the failsafe."""
    fence_depth: float = 0.0
    """Depth of the fence's floor, m; 0 for none."""
    battery_capacity: float = 0.0
    """Charge of a full battery, A.s; 0 if it is not known."""
    battery_low_voltage: float = 0.0
    """Voltage of a low battery, V; 0 for none."""
    battery_low_charge: float = 0.0
    """Share of the charge at which the battery is low; 0 for none."""
    battery_action: str = "none"
    """What it does with a low battery: one of the actions of the failsafe."""
    watches_stations: bool = True
    """Whether the failsafe acts when all ground stations are lost."""
    station_to_arm: bool = False
    """Whether it arms in the presence of a ground station alone, if it watches them."""
    watches_manual_control: bool = True
    """Whether the failsafe acts when manual control is lost."""
    manual_failsafe: str = ""
    """What it then does: an action, ``off``, or that of the failsafe if it is empty."""
    pilot_system: int = 255
    """System whose manual control acts, in an ArduPilot."""
    buttons: dict[int, int] = field(default_factory=dict)
    """Functions of a joystick's buttons, then with the shift button; empty: they have none."""
    gain_start: float = 1.0
    """Share of the joystick's axes that acts before a button changes it."""
    gain_least: float = 0.25
    gain_most: float = 1.0
    gain_steps: int = 4
    """Gains from least to most."""
    arming_check: int = ALL_CHECKS
    speedup: float = 1.0
    """Simulated seconds per second of wall time; while paused, those before and afterwards."""
    paused: bool = False
    simulated: dict[str, float] = field(default_factory=dict)
    """What stations have set of the SIM_ parameters that are faults."""
    failures_allowed: bool = True
    """Whether stations may inject failures."""

    @property
    def leg_speed(self) -> float:
        """Speed of a leg that names none, m/s."""
        return self.waypoint_speed or self.cruise_speed

    def checks(self, check: int = 0) -> bool:
        """Return whether arming waits for ``check``; without one, for all without a bit."""
        return bool(self.arming_check & (ALL_CHECKS | check) if check else self.arming_check)
