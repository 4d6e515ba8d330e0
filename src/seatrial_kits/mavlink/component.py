"""The MAVLink link as a component: estimates in, commands of ground stations out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import report
from seatrial.links.endpoints.url import open_endpoints, other_end
from seatrial.links.geodesy import Origin
from seatrial.links.parameter_validation import (
    serial_number,
    start_us,
    value_names,
    version,
    whole_number,
)
from seatrial.links.servos import read_servos
from seatrial.links.unconnected import is_connected
from seatrial.model.sampled import Sampled

from .modes import MANUAL_MODES, dialect
from .node import Node
from .outputs import SHARED, Outputs
from .parameters.file import ParameterFile
from .parameters.parameters import vehicle_parameters
from .parameters.table import ParameterTable
from .parameters.tunable import MOST_TUNABLES, tunable_parameters
from .pause import stand_still
from .ports import NAMED_VALUES, VEHICLE_TYPES, MavlinkPorts
from .services.failures import UNITS, failing_units
from .settings import Settings
from .signing import Signing, read_key
from .state_file import StateFile
from .tlog import TelemetryLog
from .transport import EndpointTransport
from .vehicle import FIXES, MANUAL_RELEASED, Estimates, Identity, Receiver, Target, Vehicle, Way

_STAYS = 2
"""The least of guidance's states in which it goes or stays somewhere."""


class Mavlink(MavlinkPorts):
    """A vehicle that ground stations see, command and guide over MAVLink 2.

    Every ``period`` it takes in what has arrived, and sends what is due; what it was commanded is
    on the outputs from the instant after. Times and rates are simulated; the wall clock serves
    sockets and signatures alone. So a run without listeners is the same each time.

    **Links**: URLs separated by spaces, as `endpoints.url` has them. Peers that are not there are
    no error; a malformed URL, or a port that cannot be had, is. Streams and their rates are
    those of `service_streams` and of each link.

    **Kinds of vehicle**: ``ardupilotmega`` has the modes of ArduPilot's Rover (boats) and Sub
    (submarines), ``px4`` those of PX4. It starts in ``mode_start``, and disarmed unless
    ``armed_start`` is on.

    **Outputs** are named after the inputs of `Guidance`. ``manual`` is 0 unless the vehicle is
    armed in a manual mode. ``target_valid`` is false without a set-point: it then stays.

    **Missions** are uploaded, or read from ``plan_folder`` (`Plans`), and carried out leg by leg
    in the mode auto: see `MissionRunner`. The vehicle must be inside its fence (`FenceService`),
    and returns to the nearest of home and the rally points.

    **Parameters** are those that stations look for in vehicles of this kind, and the rig's
    ``tunables``, which are on the output ``tunable`` in their order, for connections to other
    components' tunable parameters. What is set is kept in ``parameter_file``, relative to the
    current folder.

    **Left alone** it carries out ``failsafe`` if it is armed: when all ground stations were
    silent for ``station_timeout``, and in a manual mode when manual control was for
    ``manual_timeout``. Set-points apply for ``target_timeout``. See `Failsafe`.

    **Live**: stations set the ``speedup``, which a trial may pace its run by, and inject failures:
    ``failure`` goes to the input ``fault`` of devices, for the units that ``failures`` lists
    (`FailureService`), and so do what ArduPilot's SIM_ parameters mean (`simulated_faults`). At a
    speed-up of 0 it stands still in its step, serves its links, and so keeps everything waiting
    (`stand_still`).

    **Measurements**: what nothing is connected to, or was never valid, is not reported: not as a
    message, or as the unknown value of a field (`Estimates`), nor as a sensor in SYS_STATUS.

    **Signatures**: with ``signing_key_file``, whose first line is the pass phrase, unsigned and
    repeated frames are refused, heartbeats too, and peers that come by themselves are sent nothing
    before their first signed frame; ``state_file`` keeps the newest timestamp.
    Both are relative to the current folder. A key never comes over a link.

    Positions in {n} from the origin (``latitude``, ``longitude``, ``altitude``), depth being
    negative altitude (`Origin`); attitude ZYX; angles rad. A submarine's ``depth``, while it is
    valid, takes the place of its position's down, and is reported as pressure too: hydrostatic,
    of fresh water at 1000 kg/m3 under 101 325 Pa. Truth goes out as SIM_STATE if
    ``truth`` is on.

    Not here: radio channels with losses and delays, files that stations write, cameras. It cannot
    be rolled back: what was sent has been sent.

    The last frame to every peer is a HEARTBEAT that says disarmed; whoever supervises the run sends
    it if that ends without closing the links.

    It keeps a log of all frames, ``NAME.tlog``, in ``run_folder`` (`TelemetryLog`), which stations
    download (`LogService`).

    Raises InputError at the start for a link, file, date, version, name or failsafe that cannot
    be.
    """

    rolls_back = False
    transient = Sampled.transient | {"_node", "_transport", "_log", "_parameters", "_settings"}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._node: Node | None = None
        self._transport: EndpointTransport | None = None
        self._log = TelemetryLog(0)

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Make the vehicle and open the links."""
        self.close()
        try:
            identity = self._identity()
            kind = dialect(self.autopilot_type, submerged=identity.submerged)
            mode = kind.mode(self.mode_start)
            if mode is None:
                raise InputError(f"mode_start: this kind of vehicle has no {self.mode_start!r}")
            origin = Origin(self.latitude, self.longitude, self.altitude)
            vehicle = Vehicle(identity, kind, origin, mode, receiver=self._receiver())
            vehicle.armed = self.armed_start == "on"
            self._outputs = Outputs(read_servos(self.actuators))
            self._value_names = value_names(self.names, NAMED_VALUES)
            self._begun = t
            self._known: set[str] = set()
            self._log = TelemetryLog(identity.boot_unix_us)
            self._transport = self._opened(identity)
            plans = Path(self.plan_folder) if self.plan_folder else None
            settings = self._made_settings()
            self._parameters = self._table(vehicle, settings)
            self._settings = settings
            self._failing: dict[str, str] = {}
            self._node = Node(
                vehicle,
                self._transport,
                settings,
                self._parameters,
                plans,
                failures=failing_units(self.failures),
                log=lambda: self._log.path,
            )
        except InputError as error:
            self.close()
            raise InputError(f"{self.name}: {error}") from None

    def sample(self, t: float, k: int) -> None:
        """Publish what the vehicle was commanded until now."""
        vehicle = self._vehicle
        self.mode, self.armed = vehicle.mode.name, vehicle.armed
        driven = vehicle.armed and vehicle.mode.name in MANUAL_MODES
        self.manual = vehicle.manual if driven else MANUAL_RELEASED
        target = vehicle.target
        self.target_valid = target is not None
        shown = target or Target("position")
        self.target_kind, self.target_position = shown.kind, shown.position
        self.target_velocity, self.target_heading = shown.velocity, shown.heading
        self.target_speed = shown.speed
        assert self._node is not None
        self.home = self._node.rally.refuge
        leg = self._node.missions.leg
        self.leg, self.leg_from, self.leg_to = leg.number, leg.start, leg.end
        self.leg_speed, self.leg_radius = leg.speed, leg.radius
        self.leg_wait, self.leg_circle = leg.wait, leg.circle
        tuned = [self._parameters[name] for name in self._tunable_names]
        self.tunable = (*tuned, *(0.0,) * (MOST_TUNABLES - len(tuned)))
        failing = self._node.failures.texts(self.latitude)
        if failing != self._failing:  # seldom, and there are many
            self._failing = dict(failing)
            self.failure = [failing.get(unit, "none") for unit in UNITS]
        self.speedup = self._settings.speedup
        self.order = vehicle.order
        self.failsafe_active, self.ground_stations = vehicle.failsafe, vehicle.stations
        self.reached_at = " ".join(other_end(url) for url in self.urls)
        assert self._transport is not None
        self.frames_refused = self._transport.refused
        report(self, self._transport.endpoints)

    def update(self, t: float, k: int) -> None:
        """Take in what has arrived, and send what is due."""
        assert self._transport is not None
        assert self._node is not None
        now = self._log.now = t - self._begun
        if self.run_folder and not self._log.is_open:
            self._log.open(Path(self.run_folder, f"{self.name}.tlog"))
        self._node.missions.reached = self.leg_reached
        self._vehicle.estimates, self._vehicle.now = self._estimates(), t
        self._vehicle.truth = self.true_motion() if self.truth == "on" else None
        self._exchange(now)
        if self._settings.paused:
            stand_still(lambda: self._exchange(now), self._node, self._settings, self._parameters)

    def hold(self, t: float) -> None:
        """Publish how long it stood still."""
        self.paused = self._vehicle.paused_s

    def close(self) -> None:
        """Send the last heartbeat, which says disarmed, and close the links."""
        if self._transport is not None:
            if self._node is not None:
                self._transport.broadcast(self._node.presence.last())
            self._transport.close()
        self._transport = self._node = None
        self._log.close()

    @property
    def urls(self) -> list[str]:
        """URLs of the links as they are bound: with a port's number where 0 was given."""
        return [] if self._transport is None else [link.url for link in self._transport.endpoints]

    # ------------------------------------------------------------------ inside

    @property
    def _vehicle(self) -> Vehicle:
        assert self._node is not None
        return self._node.vehicle

    def _exchange(self, now: float) -> bool:
        """Take in what has arrived, and send what is due; return whether anything has arrived."""
        assert self._transport is not None
        assert self._node is not None
        arrived = self._transport.poll()
        # Before anybody is sent that the vehicle is armed: this process may end at any moment.
        self._transport.keep_last(self._node.presence.last())
        for message, sender in arrived:
            self._node.receive(message, sender, now)
        self._node.tick(now)
        return bool(arrived)

    def _identity(self) -> Identity:
        return Identity(
            whole_number("system_id", self.system_id),
            whole_number("component_id", self.component_id),
            VEHICLE_TYPES[self.vehicle_type],
            self.vehicle_type == "submarine",
            version(self.firmware_version),
            serial_number(self.uid),
            start_us(self.date),
        )

    def _made_settings(self) -> Settings:
        return Settings(
            self.failsafe,
            self.station_timeout,
            self.manual_timeout,
            self.target_timeout,
            self.full_speed,
            station_to_arm=bool(self.signing_key_file),
            cruise_speed=self.cruise_speed,
            waypoint_radius=self.waypoint_radius,
            loiter_radius=self.loiter_radius,
            fence_action=self.fence_action,
            fence_depth=self.fence_depth,
            battery_capacity=self.battery_capacity,
            battery_low_voltage=self.battery_low_voltage,
            battery_low_charge=self.battery_low_charge,
            battery_action=self.battery_action,
            speedup=self.speedup_start,
        )

    def _receiver(self) -> Receiver:
        satellites = whole_number("gnss_satellites", self.gnss_satellites)
        return Receiver(FIXES[self.gnss_fix], satellites, self.gnss_hdop)

    def _table(self, vehicle: Vehicle, settings: Settings) -> ParameterTable:
        file = ParameterFile(Path(self.parameter_file)) if self.parameter_file else None
        units = failing_units(self.failures)
        table = vehicle_parameters(vehicle, settings, self.actuators, self.tunables, file, units)
        self._tunable_names = [one.name for one in tunable_parameters(self.tunables)]
        return table

    def _opened(self, identity: Identity) -> EndpointTransport:
        state = StateFile(Path(self.state_file) if self.state_file else None)
        signing = None
        if self.signing_key_file:
            if not self.state_file:
                raise InputError(
                    "signing_key_file needs state_file: without it frames of an earlier run "
                    "could be repeated"
                )
            signing = Signing(read_key(Path(self.signing_key_file)), state)
        endpoints = open_endpoints("links", self.links)
        return EndpointTransport(
            endpoints, identity.system, identity.component, signing, self._log, self.name
        )

    def _measured(self) -> dict[str, tuple[Sequence[float], bool]]:
        """Return each quantity that something feeds, and whether it is valid."""
        quantities = {
            "position": (self.position_n, self.position_valid),
            "velocity": (self.velocity_n, self.position_valid),
            "heading": ((self.heading,), self.heading_valid),
            "tilt": (self.roll_pitch, self.imu_valid),
            "gyro": (self.gyro, self.gyro_valid),
            "accelerometer": (self.accelerometer, self.imu_valid),
            "depth": ((self.depth,), self.depth_valid),
        }
        return {name: one for name, one in quantities.items() if is_connected(*one[0])}

    def _estimates(self) -> Estimates:
        found = self._measured()
        valid = {name for name, (_, is_valid) in found.items() if is_valid}
        self._known |= valid

        def value(quantity: str, size: int = 3) -> Any:
            return found[quantity][0] if quantity in found else (0.0,) * size

        north, east, down = value("position")
        dives = "depth" in valid and self._vehicle.identity.submerged
        powered = self.voltage > 0.0
        pulses = self._outputs.pulses(self.pulse, dict(zip(SHARED, self.share, strict=True)))
        return Estimates(
            connected=frozenset(found),
            begun=frozenset(self._known),
            position_n=(north, east, self.depth if dives else down),
            velocity_n=value("velocity"),
            position_valid="position" in valid,
            attitude=(*value("tilt", 2), *value("heading", 1)),
            heading_valid="heading" in valid,
            tilt_valid="tilt" in valid,
            rates=value("gyro"),
            gyro_valid="gyro" in valid,
            specific_force=value("accelerometer"),
            accelerometer_valid="accelerometer" in valid,
            depth=self.depth if dives else None,
            ground_distance=self.ground_distance if self.ground_distance > 0.0 else None,
            apparent_wind=(self.wind_speed, self.wind_angle) if self.wind_valid else None,
            voltage=self.voltage if powered else None,
            current=self.current if powered and is_connected(self.current) else None,
            charge=self.charge if powered and is_connected(self.charge) else None,
            motor_speeds=tuple(self.motor_speed),
            motor_currents=tuple(self.motor_current),
            pulses=pulses,
            throttle=self._outputs.throttle(pulses),
            named=tuple(zip(self._value_names, self.named, strict=False)),
            way=self._way() if self.nav_state >= _STAYS else None,
        )

    def _way(self) -> Way:
        return Way(
            self.nav_heading,
            self.nav_speed if self.nav_speed >= 0.0 else None,
            self.nav_depth,
            self.nav_cross_track,
            self.nav_distance,
        )
