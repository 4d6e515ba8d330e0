"""Topside of a VideoRay Pro 4 as a component: manual control in, the vehicle's telemetry out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from seatrial.links.text import Inbox, Outbox
from seatrial.model.component import NS, Input, Output, Parameter, terminal
from seatrial.model.unit_table import STANDARD_GRAVITY

from .frame import encode
from .half_duplex import HalfDuplex, LineEnd
from .nmea import sentences
from .parser import Parser
from .station import PHASES, Commands, Station, manipulator_request
from .stream_file import FROM_DEVICE, TO_DEVICE

_XYZ = ("x", "y", "z")


class Pro4TopsidePorts(LineEnd):
    """Parameters, inputs and outputs of `Pro4Topside`."""

    period = Parameter(0.1, "s", "period of the command block", min=1e-3)
    node_id = Parameter(1.0, "1", "node id of the vehicle", min=1.0, max=127.0)
    baud = Parameter(115_200.0, "1/s", "baud rate", min=300.0, max=1e7)
    byte_timeout = Parameter(0.05, "s", "gap after which a frame is given up", min=1e-4)
    timeout = Parameter(1.0, "s", "silence after which the vehicle is lost", min=0.0)
    manual_limit = Parameter(1.0, "1", "thrust at full deflection", min=0.0, max=1.0)
    vertical_ahead = Parameter(
        "up",
        "1",
        "where the vertical thruster pushes with a positive number",
        choices=("up", "down"),
    )
    surface_pressure = Parameter(101_325.0, "Pa", "pressure at the surface", min=0.0)
    density = Parameter(1000.0, "kg/m3", "density of the water", min=1e-3)
    gravity = Parameter(STANDARD_GRAVITY, "m/s2", "acceleration of gravity", min=1e-3)
    nmea = Parameter("off", "1", "whether it sends NMEA sentences", choices=("off", "on"))

    rx = Input("1", "bytes received", type=str, role="bytes", optional=True)
    armed = Input("1", "whether manual control and holds apply", type=bool, optional=True)
    manual = Input(
        "1",
        "-1 to 1: ahead, turn to starboard, down",
        axes=("surge", "yaw", "heave"),
        optional=True,
    )
    lights = Input("1", "brightness, 0 to 1", optional=True)
    camera_tilt = Input("rad", "of the camera", optional=True)
    camera_focus = Input("1", "-1 to 1", optional=True)
    camera_select = Input("1", "whether the other camera is wanted", type=bool, optional=True)
    camera_buttons = Input(
        "1", "bits: menu, up, down, left, right, menu off", type=int, optional=True
    )
    manipulator = Input("1", "1 opens, -1 closes, 0 stands still", type=int, optional=True)
    hold_depth = Input("1", "whether the vehicle is to hold its depth", type=bool, optional=True)
    depth_wanted = Input("m", "depth to hold, positive down", optional=True)
    hold_heading = Input(
        "1", "whether the vehicle is to hold its heading", type=bool, optional=True
    )
    heading_wanted = Input("rad", "heading to hold, clockwise from north", optional=True)

    tx = Output("1", "bytes sent", type=str, role="bytes")
    nmea_tx = Output("1", "NMEA sentences", type=str, role="bytes")
    connected = Output("1", "whether a vehicle answers, and is driven", type=bool)
    phase = Output("1", "detect, configure, read or drive", type=str, start="detect")
    serial_number = Output("1", "of the vehicle", type=str)
    attitude = Output(
        "rad",
        "Euler angles, ZYX; psi from 0 to 2 pi",
        axes=("phi", "theta", "psi"),
        min=-math.pi,
        max=math.tau,
    )
    depth = Output("m", "depth, positive down")
    specific_force = Output("m/s2", "specific force, body axes", axes=_XYZ, frame="b")
    magnetometer = Output("1", "raw readings", axes=_XYZ)
    water_temperature = Output("K", "temperature of the water", start=273.15)
    humidity = Output("1", "relative humidity inside the vehicle")
    power = Output("1", "power that the vehicle allows its thrusters, 0 to 1")
    cycles = Output("1", "requests sent", type=int)
    missed = Output("1", "cycles without an answer before the next", type=int)
    round_trip = Output("s", "from a request's first byte to the end of its answer")
    errors = Output("1", "wrong checksums and broken frames", type=int)

    terminals: ClassVar = {
        "serial": terminal(down="tx", up="rx"),
        "deflections": terminal(
            "armed", surge="manual__surge", yaw="manual__yaw", heave="manual__heave"
        ),
        "reading": terminal(
            "depth",
            heading="attitude__psi",
            heel="attitude__phi",
            pitch="attitude__theta",
            heading_valid="connected",
            depth_valid="connected",
        ),
        "sensors": terminal(
            "depth",
            euler="attitude",
            accelerometer="specific_force",
            imu_valid="connected",
            depth_valid="connected",
        ),
    }


_MBAR = 100.0
_CELSIUS = 273.15


class Pro4Topside(Pro4TopsidePorts):
    """Sends the command block every ``period``, and decodes the replies.

    It finds the vehicle, reads its configuration and memory, and drives it (`Station`); 10 Hz is
    what the vehicle's maker and [Paulino2015] have. ``rx`` and ``tx`` are bytes with their times
    (`seatrial.links.text`), at ``baud``: join them to `Pro4Rov`, or by `SerialGateway` to a real
    vehicle.

    **Manual control**, -1 to 1, times ``manual_limit``, and 0 unless ``armed``: port = surge + yaw,
    starboard = surge - yaw, held within +-1, vertical = heave, positive downwards, whatever
    ``vertical_ahead`` is on the line. They apply for the whole cycle. ``hold_depth`` and
    ``hold_heading`` request the vehicle to hold ``depth_wanted`` (as its pressure sensor has it,
    surface_pressure + density gravity depth) and ``heading_wanted`` (whole degrees), if armed.

    **Readings** hold their last value. ``attitude`` has psi from 0 to 2 pi, whether the vehicle
    counts to 360 degrees or in halves. Depth is positive down, below ``surface_pressure``.
    ``round_trip`` is from a request's first byte to the end of its answer; ``missed`` counts
    cycles without an answer before the next; after ``timeout`` without one ``connected`` is
    false, and the vehicle is looked for, which commands nothing.

    A change of ``manipulator`` is sent after the command block, which is not answered. With
    ``nmea`` on, ``nmea_tx`` has the sentences of VideoRay's export each second (`nmea`).

    It records its stream in ``run_folder``, ``NAME.stream`` (`StreamLog`).
    """

    transient = LineEnd.transient | {"_station"}

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Start with no vehicle."""
        super().start(t)
        self._begun_ns = self._next_ns = self.now_ns
        self._next_nmea_ns = self.now_ns + NS
        self._manipulated = 0
        self._text = ""
        self._nmea: dict[str, Any] = {}
        self._errors = 0
        self._changes, self._published = 0, -1

    def step(self, t: float, h: float) -> None:
        """Receive answers, and send what is due before ``t + h``, in the order of time."""
        self._log.open(self.run_folder, self.name)
        end, before = self.now_ns + round(h * NS), self._changes
        found = self._parser.expire(self.now_ns)
        text = self.rx
        chunks = Inbox(self._rx).take(text) if text != self._text else []
        self._text = text
        for when, data in chunks:
            self._log.write(when, FROM_DEVICE, data)
            self._line.received(when, len(data))
            found += self._parser.feed(data, when, self._line.byte_ns)
        for when, frame in found:
            self._station.receive(when, frame)
        errors = self._parser.checksum_errors + self._parser.broken_off
        if found or errors != self._errors:
            self._errors = errors
            self._changes += 1
        while self._next_ns < end:
            self._cycle(self._next_ns)
            self._next_ns += self._period_ns
        while self._next_nmea_ns < end:
            if self.nmea == "on" and self._station.connected:
                self._send_nmea(self._next_nmea_ns)
            self._next_nmea_ns += NS
        if self._changes != before:
            Outbox(self._tx).flush()
            Outbox(self._nmea).flush()

    def outputs(self, t: float) -> None:
        """Publish bytes and readings, if anything has happened."""
        if self._published == self._changes:
            return
        self._published = self._changes
        station, readings = self._station, self._station.readings
        self.tx, self.nmea_tx = Outbox(self._tx).text, Outbox(self._nmea).text
        self.connected, self.phase = station.connected, PHASES[station.phase]
        self.serial_number = station.serial_number
        self.cycles, self.missed = station.cycles, station.missed
        self.round_trip = station.round_trip_ns / NS
        self.errors = self._errors
        if not readings:
            return
        angles = [math.radians(readings[name]) for name in ("roll", "pitch", "heading")]
        self.attitude = (angles[0], angles[1], angles[2] % math.tau)
        self.depth = self._depth_of(readings["pressure"])
        if "surge_acceleration" in readings:
            names = ("surge", "sway", "heave")
            self.specific_force = tuple(readings[f"{name}_acceleration"] for name in names)
            self.magnetometer = tuple(readings[f"magnetometer_{axis}"] for axis in "xyz")
            self.water_temperature = readings["water_temperature"] + _CELSIUS
            self.humidity, self.power = readings["humidity"], readings["total_power"]

    def _saved(self) -> dict[str, Any]:
        return {"station": self._station.saved()}

    def _restore(self, parts: Mapping[str, Any]) -> None:
        self._station.restore(parts["station"])

    # ------------------------------------------------------------------ inside

    def _build(self) -> None:
        self._station = Station(round(self.timeout * NS), int(self.node_id))
        self._parser = Parser(round(self.byte_timeout * NS))
        self._line = HalfDuplex(self.baud, 0)
        self._period_ns = max(1, round(self.period * NS))

    def _cycle(self, now_ns: int) -> None:
        commands = self._commands()
        self._send(now_ns, encode(self._station.request(now_ns, commands)))
        if self.manipulator != self._manipulated and self._station.connected:
            self._manipulated = self.manipulator
            direction = (self.manipulator > 0) - (self.manipulator < 0)
            self._send(now_ns, encode(manipulator_request(direction)))

    def _send(self, now_ns: int, data: bytes) -> None:
        begin = self._line.transmit(now_ns, len(data))
        self._changes += 1
        self._log.write(begin, TO_DEVICE, data)
        Outbox(self._tx).put(begin, data)

    def _commands(self) -> Commands:
        commands = Commands(
            lights=self.lights,
            camera_tilt=math.degrees(self.camera_tilt),
            camera_focus=self.camera_focus,
            camera_control=2 * self.camera_select,
            camera_buttons=self.camera_buttons,
        )
        if not self.armed:
            return commands
        surge, yaw, heave = (self.manual_limit * min(max(x, -1.0), 1.0) for x in self.manual)
        down = -1.0 if self.vertical_ahead == "up" else 1.0
        commands.thrust = (surge + yaw, surge - yaw, down * heave)
        if self.hold_depth:
            water = self.density * self.gravity * self.depth_wanted
            commands.auto_depth = (self.surface_pressure + water) / _MBAR
        if self.hold_heading:
            commands.auto_heading = math.degrees(self.heading_wanted)
        return commands

    def _depth_of(self, pressure: float) -> float:
        weight = self.density * self.gravity
        return (pressure * _MBAR - self.surface_pressure) / weight if weight else 0.0

    def _send_nmea(self, now_ns: int) -> None:
        readings = self._station.readings
        text = sentences((now_ns - self._begun_ns) / NS, readings, self._depth_of)
        Outbox(self._nmea).put(now_ns, text)
        self._changes += 1
