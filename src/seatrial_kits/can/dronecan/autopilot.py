"""DroneCAN of an autopilot: commands to ESCs and servos, and the other nodes' reports."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from dronecan.transport import Transfer

from seatrial.links.geodesy import Origin
from seatrial.model.component import NS, Input, Output, Parameter, terminal

from .channels import AXES, MOST_CHANNELS, channels_of
from .commands import messages
from .instruments import (
    BATTERY,
    BatteryInfo,
    MagneticField,
    MagneticField2,
    StaticPressure,
    StaticTemperature,
    arming,
    battery_of,
    magnetic_of,
)
from .navigation import Fix2, Solution, fixed, solved
from .node import OFFLINE_NS, DroneCanNode, NodeStatus, Task
from .parameters import Setting
from .telemetry import QUANTITIES, ActuatorStatus, EscStatus, is_status_of, reported
from .transfers import HIGH, LOW

_NED = ("north", "east", "down")
_INSTRUMENTS = ("battery", "magnetic_field", "static_pressure", "air_temperature")
_MEASURED = {
    BatteryInfo: "battery",
    MagneticField: "magnetic_field",
    MagneticField2: "magnetic_field",
    StaticPressure: "static_pressure",
    StaticTemperature: "air_temperature",
}
"""Messages of instruments, and the outputs that they are."""


class DroneCanAutopilot(DroneCanNode):
    """DroneCAN node that commands ESCs and servos.

    Every ``command_period`` it sends ``command`` to the ``channels``, named as in
    `DroneCanPeripheral`: one RawCommand for all esc, one RPMCommand for all rpm, one
    ArrayCommand for all actuators, at high priority; beyond their range they are cut off. While
    ``enabled`` is false it sends none, and the others' failsafe acts.

    The channels' status is on outputs, 0 until it is known; ``status_valid`` is whether
    it is younger than ``timeout``. So are position and velocity of the last Fix2 that had a fix
    (north-east-down from ``latitude``, ``longitude``, ``altitude``) and attitude, rates and
    acceleration of the last ahrs.Solution, with ``position_valid`` and ``attitude_valid``; of
    several senders, the last one applies. A Fix2 without a fix ends ``position_valid`` at once.

    Battery, magnetic field, pressure and temperature of the air are those received last, with
    their ``..._valid``; unknown values are 0. Every ``arming_period`` it sends ArmingStatus:
    fully armed while ``armed`` is, which nothing sets by itself.

    ``others`` is the number of nodes whose NodeStatus came in the last 3 s.

    Raises InputError at the start for channels that cannot be.
    """

    messages = (
        EscStatus,
        ActuatorStatus,
        Fix2,
        Solution,
        NodeStatus,
        BatteryInfo,
        MagneticField,
        MagneticField2,
        StaticPressure,
        StaticTemperature,
    )
    transient = DroneCanNode.transient | {"_channels", "_origin"}

    channels = Parameter("esc0 esc1", "1", "what command.c1, c2... are", check=channels_of)
    command_period = Parameter(0.02, "s", "period of commands", min=1e-3, max=60.0)
    arming_period = Parameter(0.5, "s", "period of ArmingStatus, 0: never", min=0.0, max=60.0)
    timeout = Parameter(
        1.0, "s", "age at which values of other nodes are no longer valid", min=1e-3
    )
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707, max=1.5707)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-3.1416, max=3.1416)
    altitude = Parameter(0.0, "m", "of the origin")

    command = Input("", "command: -1 to 1, or in the channel's unit", axes=AXES, optional=True)
    enabled = Input("1", "whether commands are sent", type=bool, start=True, optional=True)
    armed = Input("1", "whether the vehicle is armed", type=bool, optional=True)

    voltage = Output("V", "voltage at each ESC", axes=AXES)
    current = Output("A", "current of each ESC", axes=AXES)
    temperature = Output("K", "temperature of each ESC", axes=AXES)
    speed = Output("", "speed: rad/s, or m/s", axes=AXES)
    position = Output("", "position of each actuator: rad, or m", axes=AXES)
    force = Output("", "force of each actuator: N, or N.m", axes=AXES)
    status_valid = Output("1", "whether a channel's status is known", type=bool, axes=AXES)
    position_n = Output("m", "of the antenna, north-east-down", axes=_NED)
    velocity_n = Output("m/s", "of the antenna, north-east-down", axes=_NED)
    position_valid = Output("1", "whether there is a fix", type=bool)
    attitude = Output("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    rates = Output("rad/s", "angular velocity, body axes", axes="pqr")
    acceleration = Output("m/s2", "specific force, body axes", axes="xyz", frame="b")
    attitude_valid = Output("1", "whether attitude is valid", type=bool)
    battery_voltage = Output("V", "voltage of the battery")
    battery_current = Output("A", "current out of the battery")
    battery_temperature = Output("K", "temperature of the battery")
    battery_charge = Output("1", "charge of the battery over its capacity")
    battery_valid = Output("1", "whether the battery is known", type=bool)
    magnetic_field = Output("T", "magnetic field, body axes", axes="xyz", frame="b")
    magnetic_field_valid = Output("1", "whether the magnetic field is known", type=bool)
    static_pressure = Output("Pa", "pressure of the air")
    static_pressure_valid = Output("1", "whether the pressure is known", type=bool)
    air_temperature = Output("K", "temperature of the air")
    air_temperature_valid = Output("1", "whether the temperature is known", type=bool)
    others = Output("1", "other nodes that are there", type=int)

    terminals: ClassVar = {
        **DroneCanNode.terminals,
        "reading": terminal(
            "position_n",
            "velocity_n",
            "position_valid",
            heading="attitude__psi",
            heel="attitude__phi",
            pitch="attitude__theta",
            heading_valid="attitude_valid",
            gyro="rates",
            accelerometer="acceleration",
        ),
    }

    # ------------------------------------------------------------------ running

    def begin(self) -> None:
        """Forget what was received."""
        self._written: str = self.setting("CHANNELS")
        self._set_up()
        for name in (*QUANTITIES, "position_n", "velocity_n", "attitude", "rates", "acceleration"):
            setattr(self, name, 0.0)
        self._reported_ns: list[int | None] = [None] * len(self._channels)
        for name in (*(f"battery_{each}" for each in BATTERY), *_INSTRUMENTS[1:]):
            setattr(self, name, 0.0)
        self._measured_ns: dict[str, int] = {}
        self._fix_ns: int | None = None
        self._motion_ns: int | None = None
        self._nodes: dict[int, int] = {}

    def outputs(self, t: float) -> None:
        """Publish what is still valid, and what is sent."""
        super().outputs(t)
        missing = MOST_CHANNELS - len(self._channels)
        fresh = [self._valid(at) for at in self._reported_ns]
        self.publish("status_valid", (*fresh, *(False,) * missing))
        self.publish("position_valid", self._valid(self._fix_ns))
        self.publish("attitude_valid", self._valid(self._motion_ns))
        for name in _INSTRUMENTS:
            self.publish(f"{name}_valid", self._valid(self._measured_ns.get(name)))
        self.publish("others", sum(self.now_ns - at < OFFLINE_NS for at in self._nodes.values()))

    def settings(self) -> Sequence[Setting]:
        """Return the parameters that the bus may see."""
        return (
            Setting("CHANNELS", self.channels, check=channels_of),
            Setting("COMMAND_PERIOD", self.command_period, 1e-3, 60.0),
            Setting("ARMING_PERIOD", self.arming_period, 0.0, 60.0),
        )

    def tasks(self) -> Sequence[Task]:
        """Return its periodic messages."""
        return (
            Task("commands", self.setting("COMMAND_PERIOD"), self._send_commands, False),
            Task("arming", self.setting("ARMING_PERIOD"), self._send_arming, False),
        )

    def received(self, time_ns: int, transfer: Transfer) -> None:
        """Take in a transfer of another node."""
        message = transfer.payload
        if message._type is NodeStatus:
            self._nodes[transfer.source_node_id] = time_ns
        elif message._type is Fix2:
            found = fixed(self._origin, message)
            self._fix_ns = time_ns if found is not None else None
            if found is not None:
                self.position_n, self.velocity_n = found
        elif message._type is Solution:
            motion = solved(message)
            if motion is not None:
                self._motion_ns = time_ns
                self.attitude, self.rates, self.acceleration = motion
        elif message._type in _MEASURED:
            self._measure(time_ns, message)
        else:
            for place, channel in enumerate(self._channels):
                if is_status_of(channel, message):
                    self._reported_ns[place] = time_ns
                    self._report(place, reported(message))

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        if "_link" in state:
            self._set_up()

    # ------------------------------------------------------------------ inside

    def _set_up(self) -> None:
        """Make what follows from parameters."""
        self._channels = channels_of(self._written)
        self._origin = Origin(self.latitude, self.longitude, self.altitude)

    def _report(self, place: int, found: Mapping[str, float]) -> None:
        """Publish the status of a channel."""
        for name in QUANTITIES:
            values = list(getattr(self, name))
            values[place] = found.get(name, 0.0)
            setattr(self, name, values)

    def _measure(self, time_ns: int, message: Any) -> None:
        """Publish what an instrument or a battery says; nothing of what is not finite."""
        name = _MEASURED[message._type]
        if name == "battery":
            found: Any = battery_of(message)
            for each in BATTERY:
                setattr(self, f"battery_{each}", found.get(each, 0.0))
        elif name == "magnetic_field":
            found = magnetic_of(message)
        else:
            field = {"static_pressure": "static_pressure", "air_temperature": "static_temperature"}
            value = float(getattr(message, field[name]))
            found = value if math.isfinite(value) else None
        if found is None:
            return
        if name != "battery":
            setattr(self, name, found)
        self._measured_ns[name] = time_ns

    def _send_arming(self, time_ns: int) -> None:
        self.send(time_ns, arming(self.armed), LOW)

    def _valid(self, at: int | None) -> bool:
        return at is not None and self.now_ns - at < round(self.timeout * NS)

    def _send_commands(self, time_ns: int) -> None:
        if self.enabled:
            values = self.command[: len(self._channels)]
            for message in messages(self._channels, values):
                self.send(time_ns, message, HIGH)
