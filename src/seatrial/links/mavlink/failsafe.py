"""Failsafe actions of the vehicle."""

from __future__ import annotations

from ...errors import InputError, unknown
from .modes import Dialect
from .service import CRITICAL
from .service_arming import ArmingService
from .service_modes import ModeService
from .settings import Settings
from .vehicle import Vehicle

ACTIONS = ("none", "disarm", "hold", "loiter", "return", "surface")


class Failsafe:
    """Carries out one of `ACTIONS` in an armed vehicle: a mode, to disarm, or to report it only.

    A mode that cannot be entered (no position) is replaced by disarming: outputs go to neutral.
    Raises InputError for a mode that this kind of vehicle has not.
    """

    def __init__(
        self, vehicle: Vehicle, modes: ModeService, arming: ArmingService, settings: Settings
    ) -> None:
        check_action(vehicle.dialect, settings.failsafe)
        self._vehicle, self._modes, self._arming = vehicle, modes, arming
        self._settings = settings
        self._reasons: set[str] = set()

    def act(self, reason: str, action: str | None = None) -> None:
        """Act because of ``reason``; a vehicle that is not armed only reports it.

        ``action`` is one of `ACTIONS` instead of its own.
        """
        action = action or self._settings.failsafe
        self._reasons.add(reason)
        self._vehicle.failsafe = True
        if not self._vehicle.armed or action == "none":
            self._vehicle.report(CRITICAL, reason)
            return
        self._vehicle.report(CRITICAL, f"Failsafe: {reason}, {action}")
        mode = self._vehicle.dialect.mode(action)
        if mode is None:
            self._arming.disarm()
            return
        refused = self._modes.enter(mode)
        if refused is not None:
            self._vehicle.report(CRITICAL, f"Failsafe: {action} impossible, {refused}")
            self._arming.disarm()

    def end(self, reason: str, news: str) -> None:
        """Report that ``reason`` is over; the vehicle stays as it is."""
        self._reasons.discard(reason)
        self._vehicle.failsafe = bool(self._reasons)
        self._vehicle.report(CRITICAL, news)


def check_action(dialect: Dialect, action: str) -> None:
    """Raise InputError for an action that vehicles of this dialect cannot carry out."""
    allowed = [name for name in ACTIONS if name in ("none", "disarm") or dialect.mode(name)]
    if action not in allowed:
        raise InputError(unknown("failsafe of this vehicle", action, allowed))
