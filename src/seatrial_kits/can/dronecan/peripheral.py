"""DroneCAN peripherals of an autopilot: ESCs, servos, receivers, sensors, a battery."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

from dronecan.transport import Transfer

from seatrial.errors import InputError, unknown
from seatrial.links.atmosphere import SEA_LEVEL_K, standard_pressure
from seatrial.links.earth_field import earth_field
from seatrial.links.geodesy import Origin
from seatrial.links.parameter_validation import start_date, start_us, whole_number
from seatrial.links.unconnected import NOT_CONNECTED, is_connected
from seatrial.model.component import NS, Input, Output, Parameter, Terminal, terminal
from seatrial.physics.craft.kinematics import to_body

from .channels import AXES, MOST_CHANNELS, channels_of
from .commands import ArrayCommand, RawCommand, RPMCommand, commanded
from .instruments import BATTERY, ArmingStatus, battery, is_armed, magnetic, pressure, temperature
from .navigation import Motion, fix, solution
from .node import OFFLINE_NS, DroneCanNode, Task
from .parameters import Setting
from .telemetry import QUANTITIES, status
from .transfers import LOW, MEDIUM

_NED = ("north", "east", "down")
_LONGEST = 60.0


def check_measured(text: str) -> None:
    """Raise InputError for a text that names a quantity that no status has."""
    for name in text.split():
        if name not in QUANTITIES:
            raise InputError(unknown("quantity in measured", name, QUANTITIES))


def _measured(unit: str, description: str, **options: Any) -> Input:
    return Input(unit, description, start=NOT_CONNECTED, optional=True, **options)


class DroneCanPeripheral(DroneCanNode):
    """A node of ESCs and servos, with a GNSS receiver and an AHRS if they have a period.

    **Commands.** ``channels`` names what ``command.c1``, ``c2``... are: ``esc0`` takes element 0
    of RawCommand, and has -1 to 1; ``rpm0`` element 0 of RPMCommand, rad/s; ``actuator3`` what
    ArrayCommand has for actuator 3 in the type named: ``actuator3:unitless`` (the default, -1 to
    1), ``:position``, ``:force``, ``:speed`` (SI), ``:pwm`` (a pulse, s). ``pulse`` is the servo
    pulse of those with a command from -1 to 1, by ``pulse_min``, ``pulse_neutral``,
    ``pulse_max``, and of pwm; of others it is neutral. Commands act at the end of the step in
    which they are received.

    **Failsafe.** A channel that has had no command for ``command_timeout`` is neutral: 0, or the
    neutral pulse. So is one that has not had any yet. 0: it keeps the last one for ever.
    ``failsafe`` reports that a channel is neutral for want of commands; the node's health is a
    warning once they have stopped.

    **Status** of each channel every ``status_period``: those quantities that ``measured`` names
    are the inputs', others unknown (NaN, and for an ESC's speed 0). The share of power is the
    command's.

    **GNSS**: Fix2 every ``gnss_period`` of ``position_n`` and ``velocity_n`` around the origin
    (``latitude``, ``longitude``, ``altitude``), the time being ``date`` at the start of the run;
    without ``position_valid`` it has no fix. **AHRS**: ahrs.Solution every ``ahrs_period``, unless
    ``attitude_valid`` is false; rates and accelerations that nothing feeds are NaN. Both at once
    and then at whole periods from the start: after a sensor of the same period.

    **Battery**: BatteryInfo every ``battery_period``; what nothing feeds is unknown (NaN, and a
    charge of 127 %). **Magnetometer**: MagneticFieldStrength2 every ``magnetometer_period``, of
    ``magnetic_field``, or without one of the World Magnetic Model at the origin, turned by
    ``attitude``. **Barometer**: StaticPressure and StaticTemperature every ``barometer_period``, of
    ``static_pressure`` and ``air_temperature``, or without them of the standard atmosphere at the
    altitude of ``position_n``, and 288.15 K.

    **Arming.** ``armed`` is the ArmingStatus received: false before the first, and 3 s after the
    last. Commands act whatever it is, as those of ESCs do: what arming permits is the rig's.

    Raises InputError at the start for channels, pulses and a date that cannot be.
    """

    messages = (RawCommand, RPMCommand, ArrayCommand, ArmingStatus)
    transient = DroneCanNode.transient | {"_channels", "_origin", "_start_us", "_field_n"}

    channels = Parameter("esc0", "1", "what command.c1, c2... are", check=channels_of)
    command_timeout = Parameter(
        0.2, "s", "silence after which a channel is neutral, 0: never", min=0.0, max=_LONGEST
    )
    pulse_min = Parameter(1.1e-3, "s", "pulse of -1", min=0.0)
    pulse_neutral = Parameter(1.5e-3, "s", "pulse of 0", min=0.0)
    pulse_max = Parameter(1.9e-3, "s", "pulse of 1", min=0.0)
    status_period = Parameter(
        0.1, "s", "period of the channels' status, 0: never", min=0.0, max=_LONGEST
    )
    measured = Parameter("", "1", "quantities of the status that are known", check=check_measured)
    gnss_period = Parameter(0.0, "s", "period of Fix2, 0: never", min=0.0, max=_LONGEST)
    ahrs_period = Parameter(0.0, "s", "period of ahrs.Solution, 0: never", min=0.0, max=_LONGEST)
    battery_period = Parameter(0.0, "s", "period of BatteryInfo, 0: never", min=0.0, max=_LONGEST)
    magnetometer_period = Parameter(
        0.0, "s", "period of MagneticFieldStrength2, 0: never", min=0.0, max=_LONGEST
    )
    barometer_period = Parameter(
        0.0, "s", "period of StaticPressure and StaticTemperature, 0: never", min=0.0, max=_LONGEST
    )
    battery_id = Parameter(0.0, "1", "which battery it is", min=0.0, max=255.0)
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707, max=1.5707)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-3.1416, max=3.1416)
    altitude = Parameter(0.0, "m", "of the origin")
    date = start_date()

    voltage = Input("V", "voltage at each ESC", axes=AXES, optional=True)
    current = Input("A", "current of each ESC", axes=AXES, optional=True)
    temperature = Input("K", "temperature of each ESC", axes=AXES, optional=True)
    speed = Input("", "speed: rad/s, or m/s", axes=AXES, optional=True)
    position = Input("", "position of each actuator: rad, or m", axes=AXES, optional=True)
    force = Input("", "force of each actuator: N, or N.m", axes=AXES, optional=True)
    position_n = Input("m", "of the antenna, north-east-down", axes=_NED, optional=True)
    velocity_n = Input("m/s", "of the antenna, north-east-down", axes=_NED, optional=True)
    position_valid = Input("1", "whether there is a fix", type=bool, start=True, optional=True)
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"), optional=True)
    rates = Input(
        "rad/s", "angular velocity, body axes", start=NOT_CONNECTED, axes="pqr", optional=True
    )
    acceleration = Input(
        "m/s2",
        "specific force, body axes",
        start=NOT_CONNECTED,
        axes="xyz",
        frame="b",
        optional=True,
    )
    attitude_valid = Input("1", "whether attitude is valid", type=bool, start=True, optional=True)

    battery_voltage = _measured("V", "voltage of the battery")
    battery_current = _measured("A", "current out of the battery")
    battery_temperature = _measured("K", "temperature of the battery")
    battery_charge = _measured("1", "charge of the battery over its capacity")
    magnetic_field = _measured("T", "magnetic field, body axes", axes="xyz", frame="b")
    static_pressure = _measured("Pa", "pressure of the air")
    air_temperature = _measured("K", "temperature of the air")

    command = Output("", "command: -1 to 1, or in the channel's unit", axes=AXES)
    pulse = Output("s", "servo pulse", axes=AXES)
    failsafe = Output("1", "whether a channel is neutral for want of commands", type=bool)
    armed = Output("1", "whether the autopilot says that it is armed", type=bool)

    terminals: ClassVar = {
        **DroneCanNode.terminals,
        "sensors": terminal(
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
        "battery": terminal(
            voltage="battery_voltage", current="battery_current", charge="battery_charge"
        ),
        "actuators": Terminal({f"ch{n}": f"pulse.{axis}" for n, axis in enumerate(AXES, 1)}),
    }

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Make the node; raises InputError for values that cannot be."""
        if not self.pulse_min < self.pulse_neutral < self.pulse_max:
            raise InputError(
                f"{self.name}: pulse_min, pulse_neutral and pulse_max must rise, got "
                f"{self.pulse_min!r}, {self.pulse_neutral!r}, {self.pulse_max!r} s"
            )
        super().start(t)

    def begin(self) -> None:
        """Forget all commands."""
        self._written: str = self.setting("CHANNELS")
        self._set_up()
        self._commands = [self._neutral(place) for place in range(len(self._channels))]
        self._commanded_ns: list[int | None] = [None] * len(self._channels)
        self._armed, self._armed_ns = False, 0

    def outputs(self, t: float) -> None:
        """Publish commands, and what is sent."""
        super().outputs(t)
        channels, timeout = range(len(self._channels)), round(self.setting("COMMAND_TIMEOUT") * NS)
        late = [self._is_late(place, timeout) for place in channels]
        found = [self._neutral(p) if late[p] else self._commands[p] for p in channels]
        missing = MOST_CHANNELS - len(found)
        self.publish("command", (*found, *(0.0,) * missing))
        pulses = [self._pulse(place, value) for place, value in enumerate(found)]
        self.publish("pulse", (*pulses, *(self.pulse_neutral,) * missing))
        self.publish("failsafe", any(late))
        self.publish("armed", self._armed and self.now_ns - self._armed_ns < OFFLINE_NS)

    def settings(self) -> Sequence[Setting]:
        """Return the parameters that the bus may see."""
        return (
            Setting("CHANNELS", self.channels, check=channels_of),
            Setting("COMMAND_TIMEOUT", self.command_timeout, 0.0, _LONGEST),
            Setting("STATUS_PERIOD", self.status_period, 0.0, _LONGEST),
            Setting("GNSS_PERIOD", self.gnss_period, 0.0, _LONGEST),
            Setting("AHRS_PERIOD", self.ahrs_period, 0.0, _LONGEST),
            Setting("BATTERY_PERIOD", self.battery_period, 0.0, _LONGEST),
            Setting("MAG_PERIOD", self.magnetometer_period, 0.0, _LONGEST),
            Setting("BARO_PERIOD", self.barometer_period, 0.0, _LONGEST),
        )

    def tasks(self) -> Sequence[Task]:
        """Return its periodic messages."""
        return (
            Task("channels", self.setting("STATUS_PERIOD"), self._send_channels),
            Task("gnss", self.setting("GNSS_PERIOD"), self._send_fix, False),
            Task("ahrs", self.setting("AHRS_PERIOD"), self._send_attitude, False),
            Task("battery", self.setting("BATTERY_PERIOD"), self._send_battery, False),
            Task("magnetometer", self.setting("MAG_PERIOD"), self._send_field, False),
            Task("barometer", self.setting("BARO_PERIOD"), self._send_pressure, False),
        )

    def received(self, time_ns: int, transfer: Transfer) -> None:
        """Take in a command, or the arming status."""
        if transfer.payload._type is ArmingStatus:
            self._armed, self._armed_ns = is_armed(transfer.payload), time_ns
            return
        for place, value in commanded(self._channels, transfer.payload):
            self._commands[place], self._commanded_ns[place] = value, time_ns

    def attention(self) -> bool:
        """Return whether commands have stopped."""
        timeout = round(self.setting("COMMAND_TIMEOUT") * NS)
        return any(
            at is not None and self._is_late(place, timeout)
            for place, at in enumerate(self._commanded_ns)
        )

    def set_state(self, state: Any) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        if "_link" in state:
            self._set_up()

    # ------------------------------------------------------------------ inside

    def _set_up(self) -> None:
        """Make what follows from parameters."""
        self._channels = channels_of(self._written)
        self._origin = Origin(self.latitude, self.longitude, self.altitude)
        self._start_us = start_us(self.date)
        self._field_n = earth_field(
            self.latitude, self.longitude, self.altitude, self._start_us * 1e-6
        )

    def _neutral(self, place: int) -> float:
        neutral: float = self.pulse_neutral
        return neutral if self._channels[place].kind == "pwm" else 0.0

    def _is_late(self, place: int, timeout: int) -> bool:
        at = self._commanded_ns[place]
        return at is None or 0 < timeout <= self.now_ns - at

    def _pulse(self, place: int, command: float) -> float:
        kind, neutral = self._channels[place].kind, self.pulse_neutral
        if kind == "pwm":
            return command
        if kind not in ("esc", "unitless"):
            return float(neutral)
        end = self.pulse_max if command > 0.0 else self.pulse_min
        return float(neutral + min(abs(command), 1.0) * (end - neutral))

    def _send_channels(self, time_ns: int) -> None:
        known = {name: getattr(self, name) for name in self.measured.split()}
        for place, channel in enumerate(self._channels):
            measured = {name: values[place] for name, values in known.items()}
            demand = abs(self.command[place]) if channel.kind == "esc" else 0.0
            self.send(time_ns, status(channel, measured, demand), LOW)

    def _send_fix(self, time_ns: int) -> None:
        north, east, down = self.position_n
        utc_us = self._start_us + (time_ns - self._begun_ns) // 1000
        message = fix(
            self._origin, (north, east, down), self.velocity_n, self.position_valid, utc_us
        )
        self.send(time_ns, message, MEDIUM)

    def _send_attitude(self, time_ns: int) -> None:
        if self.attitude_valid:
            motion = Motion(tuple(self.attitude), tuple(self.rates), tuple(self.acceleration))
            self.send(time_ns, solution(motion), MEDIUM)

    def _send_battery(self, time_ns: int) -> None:
        values = [getattr(self, f"battery_{name}") for name in BATTERY]
        self.send(time_ns, battery(values, whole_number("battery_id", self.battery_id)), LOW)

    def _send_field(self, time_ns: int) -> None:
        field = self.magnetic_field
        if not is_connected(*field):
            field = to_body(self.attitude, self._field_n)
        self.send(time_ns, magnetic(field), MEDIUM)

    def _send_pressure(self, time_ns: int) -> None:
        altitude = self.altitude - self.position_n[2]
        given = is_connected(self.static_pressure)
        value = self.static_pressure if given else standard_pressure(altitude)
        self.send(time_ns, pressure(value), MEDIUM)
        known = is_connected(self.air_temperature)
        kelvin = self.air_temperature if known else SEA_LEVEL_K
        self.send(time_ns, temperature(kelvin), LOW)
