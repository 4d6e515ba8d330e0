"""Arming, with checks that give their reasons."""

from __future__ import annotations

from collections.abc import Callable

from pymavlink.dialects.v20 import all as mavlink

from ..service import (
    ACCEPTED,
    CRITICAL,
    FAILED,
    INFO,
    UNSUPPORTED,
    WARNING,
    Command,
    Service,
    on_command,
)
from ..settings import COMPASS_CHECK, GPS_CHECK, Settings
from ..transport import Sender, Transport
from ..vehicle import Vehicle

FORCE = 21196.0
"""Parameter 2 of COMPONENT_ARM_DISARM that arms against all checks."""

Check = Callable[[], str | None]
"""Returns the reason against arming, None if there is none."""


class ArmingService(Service):
    """COMPONENT_ARM_DISARM and RUN_PREARM_CHECKS.

    A boat needs a position and a heading, a submarine a heading; other services add ``checks``
    of theirs, and the settings say which of them apply. It does not arm in a failsafe. Each reason
    against arming is reported. Disarming always works, and so does arming by `FORCE`, which is
    reported.
    """

    def __init__(self, vehicle: Vehicle, transport: Transport, settings: Settings) -> None:
        super().__init__(vehicle, transport)
        self._settings = settings
        self.checks: list[Check] = [self._needs_position, self._needs_heading, self._needs_mode]
        self.lasting: dict[str, None] = {}
        """Reasons of failsafes that last."""

    def disarm(self) -> None:
        """Disarm."""
        if self.vehicle.armed:
            self.vehicle.armed = False
            self.vehicle.report(INFO, "Disarmed")

    def tick(self, now: float) -> None:
        """Keep the health bit."""
        self.vehicle.healthy = not self._reasons()

    def _reasons(self) -> list[str]:
        if not self._settings.checks():
            return []
        found = dict.fromkeys(reason for check in self.checks if (reason := check()) is not None)
        return [*(found | self.lasting)]

    @on_command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM)
    def _arm_or_disarm(self, command: Command, sender: Sender, now: float) -> int:
        wanted, how = command.parameters[:2]
        if wanted == 0.0:
            self.disarm()
            return ACCEPTED
        if wanted != 1.0:
            return UNSUPPORTED
        reasons = [] if self.vehicle.armed else self._reasons()
        if reasons and how != FORCE:
            self._report(reasons)
            return FAILED
        if not self.vehicle.armed:
            self.vehicle.armed = True
            forced = f" by force, against: {', '.join(reasons)}" if reasons else ""
            self.vehicle.report(WARNING if forced else INFO, f"Armed{forced}")
        return ACCEPTED

    @on_command(mavlink.MAV_CMD_RUN_PREARM_CHECKS)
    def _run_checks(self, command: Command, sender: Sender, now: float) -> int:
        if self.vehicle.armed:
            return int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
        reasons = self._reasons()
        self._report(reasons)
        if not reasons:
            self.vehicle.report(INFO, "Ready to arm")
        return ACCEPTED

    def _report(self, reasons: list[str]) -> None:
        for reason in reasons:
            self.vehicle.report(CRITICAL, f"PreArm: {reason}")

    def _needs_position(self) -> str | None:
        needed = self._settings.checks(GPS_CHECK) and not self.vehicle.identity.submerged
        return "no position" if needed and not self.vehicle.estimates.position_valid else None

    def _needs_heading(self) -> str | None:
        needed = self._settings.checks(COMPASS_CHECK)
        return "no heading" if needed and not self.vehicle.estimates.heading_valid else None

    def _needs_mode(self) -> str | None:
        mode, is_ardupilot = self.vehicle.mode, self.vehicle.dialect.is_ardupilot
        return f"not in mode {mode.shown}" if is_ardupilot and mode.name == "return" else None
