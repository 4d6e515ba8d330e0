"""Failsafe actions of the vehicle."""

from __future__ import annotations

from seatrial.errors import InputError, unknown

from ..modes import Dialect
from ..service import CRITICAL
from ..settings import Settings
from ..vehicle import Vehicle
from .arming import ArmingService
from .modes import ModeService

ACTIONS = ("none", "disarm", "hold", "loiter", "return", "surface")


class Failsafe:
    """Carries out one of `ACTIONS` in an armed vehicle: a mode, to disarm, or to report it only.

    A mode that cannot be entered (no position) is replaced by disarming: outputs go to neutral.
    While a reason lasts the vehicle does not arm, unless by force or for a reason that is reported
    only. Raises InputError for a mode that this kind of vehicle has not.
    """

    def __init__(
        self, vehicle: Vehicle, modes: ModeService, arming: ArmingService, settings: Settings
    ) -> None:
        check_action(vehicle.dialect, settings.failsafe)
        self._vehicle, self._modes, self._arming = vehicle, modes, arming
        self._settings = settings
        self._reasons: set[str] = set()
        self._left_at: dict[str, float] = {}
        """Simulated times, s, since which an armed vehicle is not as the reason has left it."""

    def act(self, reason: str, action: str | None = None, *, prevents: bool = True) -> None:
        """Act because of ``reason``; a vehicle that is not armed only reports it.

        ``action`` is one of `ACTIONS` instead of its own; ``prevents`` says whether it does not arm
        until the reason's end.
        """
        action = action or self._settings.failsafe
        self._reasons.add(reason)
        self._vehicle.failsafe = True
        if prevents and action != "none":
            self._arming.lasting[reason] = None
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

    def act_again(
        self, reason: str, now: float, patience: float, action: str | None = None
    ) -> None:
        """Act because of ``reason``, which lasts, on an armed vehicle that was taken over.

        ``patience`` s after: who takes over has that time to bring back what was lost. Times are
        simulated.
        """
        action = action or self._settings.failsafe
        is_as_left = self._vehicle.mode == self._vehicle.dialect.mode(action)
        if not self._vehicle.armed or action == "none" or is_as_left:
            self._left_at.pop(reason, None)
        elif now - self._left_at.setdefault(reason, now) > patience:
            del self._left_at[reason]
            self.act(reason, action)

    def end(self, reason: str, news: str) -> None:
        """Report that ``reason`` is over, if it was one; the vehicle stays as it is."""
        self._left_at.pop(reason, None)
        if reason not in self._reasons:
            return
        self._reasons.remove(reason)
        self._arming.lasting.pop(reason, None)
        self._vehicle.failsafe = bool(self._reasons)
        self._vehicle.report(CRITICAL, news)


def check_action(dialect: Dialect, action: str) -> None:
    """Raise InputError for an action that vehicles of this dialect cannot carry out."""
    allowed = [name for name in ACTIONS if name in ("none", "disarm") or dialect.mode(name)]
    if action not in allowed:
        raise InputError(unknown("failsafe of this vehicle", action, allowed))
