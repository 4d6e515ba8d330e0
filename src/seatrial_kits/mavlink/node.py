"""MAVLink node of the vehicle: its services, and the routing of messages to them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from seatrial.links.geodesy import Ned

from .codec import Message
from .missions.plan import Plans
from .parameters.pack import packed
from .parameters.table import ParameterTable
from .service import Builder, Handler, Receiver, Service
from .services.arming import ArmingService
from .services.battery import BatteryService
from .services.clock import ClockService
from .services.commands import CommandService, RefusalService
from .services.failsafe import Failsafe
from .services.failures import FailureService
from .services.fence import FenceService
from .services.files import Files, FileService
from .services.guided import GuidedService
from .services.home import HomeService
from .services.joystick import JoystickService
from .services.log import LogService
from .services.manual_control import ManualControlService
from .services.missions import MissionService
from .services.modes import ModeService
from .services.parameters import ParameterService
from .services.presence import PresenceService
from .services.rally import RallyService
from .services.stations import StationService
from .services.streams import StreamService
from .services.transfer import TransferService
from .settings import Settings
from .telemetry.board import BoardTelemetry
from .telemetry.estimator import EstimatorTelemetry
from .telemetry.motion import MotionTelemetry
from .telemetry.motors import MotorTelemetry
from .telemetry.navigation import NavigationTelemetry
from .telemetry.odometry import OdometryTelemetry
from .telemetry.sensors import SensorTelemetry
from .telemetry.system import SystemTelemetry
from .transport import Sender, Transport
from .vehicle import Vehicle

_PLAIN: tuple[type[Service], ...] = (
    RefusalService,
    MotionTelemetry,
    OdometryTelemetry,
    SensorTelemetry,
    SystemTelemetry,
    EstimatorTelemetry,
    BoardTelemetry,
)
"""Services that need vehicle and transport alone."""


class Node:
    """All services of one vehicle.

    `receive` takes messages one by one, `tick` lets time pass; answers and streams go to
    ``transport``. Messages of the vehicle itself, and those meant for another system or component,
    are ignored. Missions, fence and rally points are kept in ``plans``, a folder.
    ``clock`` is wall time, s, by which ground stations live. ``failures`` are the units that can
    fail. ``log`` names the run's telemetry log, while there is one.
    Raises InputError for settings that the vehicle cannot have, and for what is in the folder.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        settings: Settings,
        parameters: ParameterTable,
        plans: Path | None = None,
        clock: Callable[[], float] = time.monotonic,
        failures: Sequence[str] = (),
        log: Callable[[], Path | None] = lambda: None,
    ) -> None:
        self.vehicle = vehicle
        handlers: dict[int, Handler] = {}
        builders: dict[int, Builder] = {}
        intervals: dict[int, float] = {}
        modes, arming = ModeService(vehicle, transport), ArmingService(vehicle, transport, settings)
        failsafe = Failsafe(vehicle, modes, arming, settings)
        home = HomeService(vehicle, transport)
        lists = Plans(vehicle, plans)
        rally = RallyService(vehicle, transport, lists.rally)
        fence = FenceService(vehicle, transport, lists.fence, settings, failsafe)
        stations = StationService(vehicle, transport, failsafe, settings, clock)
        arming.checks += [fence.check, stations.check]
        guided = GuidedService(vehicle, transport, modes, settings)
        self.missions = MissionService(
            vehicle,
            transport,
            lists.mission,
            settings,
            modes,
            handlers,
            lambda: rally.refuge,
            guided.change_speed,
        )
        self.rally = rally
        self.failures = FailureService(vehicle, transport, settings, failures)
        joystick = JoystickService(vehicle, transport, settings, handlers)
        self.presence = PresenceService(vehicle, transport)
        self.services: list[Service] = [
            CommandService(vehicle, transport, handlers),
            arming,
            modes,
            stations,
            joystick,
            ManualControlService(vehicle, transport, failsafe, settings, lambda: joystick.gain),
            guided,
            home,
            TransferService(vehicle, transport, lists),
            fence,
            rally,
            self.missions,
            ParameterService(vehicle, transport, parameters),
            self.failures,
            BatteryService(vehicle, transport, settings, failsafe),
            ClockService(vehicle, transport),
            FileService(vehicle, transport, files_on_board(parameters)),
            LogService(vehicle, transport, log),
            *(service(vehicle, transport) for service in _PLAIN),
            NavigationTelemetry(vehicle, transport, lambda: self.goal),
            MotorTelemetry(vehicle, transport),
            # What the others changed is reported last.
            self.presence,
            StreamService(vehicle, transport, builders, intervals),
        ]
        self._neighbours: set[int] = set()
        """Other components of its system that were received."""
        self._receivers: dict[int, list[Receiver]] = {}
        """By number, in the order of the services."""
        self._register(handlers, builders, intervals)

    def _register(
        self, handlers: dict[int, Handler], builders: dict[int, Builder], streams: dict[int, float]
    ) -> None:
        for service in self.services:
            for number, receive in service.receivers.items():
                self._receivers.setdefault(number, []).append(receive)
            handlers.update(service.commands)
            builders.update(service.messages)
            streams.update(service.streams)
            self.vehicle.capabilities |= service.capabilities

    @property
    def goal(self) -> Ned | None:
        """Position the vehicle goes to, in {n}; None for a heading, a velocity, or none."""
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
        """Give a message to the services that take it in, at simulated time ``now``, s."""
        if sender.system == self.vehicle.identity.system:
            self._neighbours.add(sender.component)
        receivers = self._receivers.get(message.get_msgId(), ())
        if receivers and self._is_for_us(message, sender):
            for receive in receivers:
                receive(message, sender, now)

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
        # An ArduPilot answers for components of its system that it does not know.
        known = {*self._neighbours, identity.component} if self.vehicle.dialect.is_ardupilot else ()
        is_ours = component in (0, identity.component) or (known and component not in known)
        return system in (0, identity.system) and bool(is_ours)


def files_on_board(parameters: ParameterTable) -> Files:
    """Return the files that stations may read."""
    return {
        "@PARAM/param.pck": lambda query: packed(
            parameters, defaults="withdefaults=1" in query.split("&")
        )
    }
