"""The vehicle's node on the network: its services, and who gets which message."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from pymavlink.dialects.v20 import all as mavlink

from ..geodesy import Ned
from .codec import Message
from .failsafe import Failsafe
from .parameter_table import ParameterTable
from .plan import Plans
from .radio import Air, Sender
from .service import Builder, Handler, Service
from .service_arming import ArmingService
from .service_clock import ClockService
from .service_commands import CommandService
from .service_failures import FailureService
from .service_fence import FenceService
from .service_files import FileService
from .service_guided import GuidedService
from .service_home import HomeService
from .service_missions import MissionService
from .service_modes import ModeService
from .service_parameters import ParameterService
from .service_presence import PresenceService
from .service_rally import RallyService
from .service_refusals import RefusalService
from .service_stations import StationService
from .service_sticks import StickService
from .service_streams import StreamService
from .service_transfer import TransferService
from .settings import Settings
from .telemetry_motion import MotionTelemetry
from .telemetry_navigation import NavigationTelemetry
from .telemetry_odometry import OdometryTelemetry
from .telemetry_sensors import SensorTelemetry
from .telemetry_system import SystemTelemetry
from .vehicle import Vehicle


class Node:
    """All services of one vehicle.

    `receive` takes messages one by one, `tick` lets time pass; answers and streams go to
    ``air``. Messages of the vehicle itself, and those meant for another system or component,
    are nobody's business here. Missions, fence and rally points are kept in ``plans``, a folder.
    ``clock`` is wall time, s, by which ground stations live. ``failures`` are the units that can
    fail.
    Raises InputError for settings that the vehicle cannot have, and for what is in the folder.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        air: Air,
        settings: Settings,
        parameters: ParameterTable,
        plans: Path | None = None,
        clock: Callable[[], float] = time.monotonic,
        failures: Sequence[str] = (),
    ) -> None:
        self.vehicle = vehicle
        handlers: dict[int, Handler] = {}
        builders: dict[int, Builder] = {}
        intervals: dict[int, float] = {}
        modes, arming = ModeService(vehicle, air), ArmingService(vehicle, air, settings)
        failsafe = Failsafe(vehicle, modes, arming, settings)
        home = HomeService(vehicle, air)
        lists = Plans(vehicle, plans)
        rally = RallyService(vehicle, air, lists.rally)
        fence = FenceService(vehicle, air, lists.fence, settings, failsafe)
        arming.checks.append(fence.check)
        guided = GuidedService(vehicle, air, modes, settings)
        self.missions = MissionService(
            *(vehicle, air, lists.mission, settings, modes),
            home.commands[mavlink.MAV_CMD_DO_SET_HOME],
            lambda: rally.refuge,
            guided.change_speed,
        )
        self.rally = rally
        self.failures = FailureService(vehicle, air, settings, failures)
        self.services: list[Service] = [
            CommandService(vehicle, air, handlers),
            arming,
            modes,
            StationService(vehicle, air, failsafe, settings, clock),
            StickService(vehicle, air, failsafe, settings),
            guided,
            home,
            TransferService(vehicle, air, lists),
            fence,
            rally,
            self.missions,
            ParameterService(vehicle, air, parameters),
            self.failures,
            ClockService(vehicle, air),
            FileService(vehicle, air),
            RefusalService(vehicle, air),
            MotionTelemetry(vehicle, air),
            OdometryTelemetry(vehicle, air),
            SensorTelemetry(vehicle, air),
            SystemTelemetry(vehicle, air),
            NavigationTelemetry(vehicle, air, lambda: self.goal),
            # What the others changed is told last.
            PresenceService(vehicle, air),
            StreamService(vehicle, air, builders, intervals),
        ]
        for service in self.services:
            handlers.update(service.commands)
            builders.update(service.messages)
            intervals.update(service.streams)
            vehicle.capabilities |= service.capabilities

    @property
    def goal(self) -> Ned | None:
        """Where the vehicle goes to, in {n}; None for a heading, a velocity, or nowhere."""
        target, leg = self.vehicle.target, self.missions.leg
        match self.vehicle.mode.name:
            case "auto" if leg.number:
                return leg.end
            case "return":
                return self.rally.refuge
            case "guided" if target is not None and target.kind == "position":
                return target.position
        return None

    def receive(self, message: Message, sender: Sender, now: float) -> None:
        """Give a message to all services, at simulated time ``now``, s."""
        if self._is_for_us(message, sender):
            for service in self.services:
                service.handle(message, sender, now)

    def tick(self, now: float) -> None:
        """Let all services act at simulated time ``now``, s."""
        for service in self.services:
            service.tick(now)

    def _is_for_us(self, message: Message, sender: Sender) -> bool:
        identity = self.vehicle.identity
        if (sender.system, sender.component) == (identity.system, identity.component):
            return False
        # MANUAL_CONTROL has another name for it.
        system = getattr(message, "target_system", getattr(message, "target", 0))
        component = getattr(message, "target_component", 0)
        return system in (0, identity.system) and component in (0, identity.component)
