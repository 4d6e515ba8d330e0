"""State of the vehicle that the services share: measurements, commands, presence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned, Origin
from seatrial.links.truth import Truth
from seatrial.model.unit_table import STANDARD_GRAVITY

from .modes import Dialect, Mode

CHANNELS = 16
"""Servo outputs of a vehicle."""

MANUAL_RELEASED = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Identity:
    """Identity of the vehicle on a MAVLink network."""

    system: int
    component: int
    vehicle_type: int
    """MAV_TYPE."""
    submerged: bool
    firmware_version: str
    uid: int
    boot_unix_us: int
    """Unix time of the start of the run, us; simulated time counts from there."""


FIXES = {
    "3d": mavlink.GPS_FIX_TYPE_3D_FIX,
    "dgps": mavlink.GPS_FIX_TYPE_DGPS,
    "rtk-float": mavlink.GPS_FIX_TYPE_RTK_FLOAT,
    "rtk-fixed": mavlink.GPS_FIX_TYPE_RTK_FIXED,
}
"""GPS_FIX_TYPE of a receiver with a position, by name."""


@dataclass(frozen=True)
class Receiver:
    """What a satellite receiver reports beside its position."""

    fix: int = mavlink.GPS_FIX_TYPE_3D_FIX
    """GPS_FIX_TYPE."""
    satellites: int = 12
    hdop: float | None = 1.0


NO_FIX = Receiver(mavlink.GPS_FIX_TYPE_NO_FIX, 0, None)


@dataclass(frozen=True)
class Way:
    """Guidance's commanded course, and the vehicle's errors. SI, rad."""

    heading: float
    speed: float | None
    """Over ground, along the bow; None if no speed is wanted."""
    depth: float
    cross_track: float
    """From leg or circle, positive to starboard of it."""
    distance: float
    """Horizontal, to the end of the leg or the point to stay at."""


QUANTITIES = frozenset(
    {"position", "velocity", "heading", "tilt", "gyro", "accelerometer", "depth"}
)
"""Quantities that a vehicle may measure; the tilt is roll and pitch."""


@dataclass(frozen=True)
class Estimates:
    """Estimates that the vehicle measures. SI, rad; {n} north-east-down, {b} bow-starboard-down.

    A quantity that is not ``connected`` is never measured; one that was valid at least once is
    ``begun``. All numbers are finite: of a quantity that has not begun they mean nothing.
    """

    connected: frozenset[str] = QUANTITIES
    begun: frozenset[str] = QUANTITIES

    position_n: Ned = (0.0, 0.0, 0.0)
    velocity_n: Ned = (0.0, 0.0, 0.0)
    position_valid: bool = False
    attitude: Ned = (0.0, 0.0, 0.0)
    """Euler angles ZYX: phi, theta, psi."""
    heading_valid: bool = True
    tilt_valid: bool = True
    rates: Ned = (0.0, 0.0, 0.0)
    gyro_valid: bool = True
    specific_force: Ned = (0.0, 0.0, -STANDARD_GRAVITY)
    accelerometer_valid: bool = True
    depth: float | None = None
    """Of a submarine, positive down."""
    ground_distance: float | None = None
    """To the ground below."""
    apparent_wind: tuple[float, float] | None = None
    """Speed, and direction it blows to from the bow, to starboard positive."""
    voltage: float | None = None
    current: float | None = None
    charge: float | None = None
    """Share of the battery that is left, 0 to 1."""
    motor_speeds: tuple[float, ...] = ()
    motor_currents: tuple[float, ...] = ()
    """As many of both; motors that nothing is known of are 0."""
    pulses: tuple[float, ...] = (0.0,) * CHANNELS
    """Servo pulses; 0 is an output that is not used."""
    throttle: float | None = None
    """Mean share of full thrust ahead, 0 to 1."""
    named: tuple[tuple[str, float], ...] = ()
    way: Way | None = None
    """None while guidance neither stays somewhere nor goes anywhere."""

    def has(self, *quantities: str) -> bool:
        """Return whether one of the quantities has begun, and no connected one is still to."""
        wanted = self.connected.intersection(quantities)
        return bool(wanted) and wanted <= self.begun

    @property
    def shown_attitude(self) -> Ned:
        """Euler angles, NaN where there is no measurement."""
        phi, theta = self._shown("tilt", self.attitude[:2])
        (psi,) = self._shown("heading", self.attitude[2:])
        return phi, theta, psi

    @property
    def shown_rates(self) -> Ned:
        """Rates, NaN where there is no measurement."""
        p, q, r = self._shown("gyro", self.rates)
        return p, q, r

    @property
    def shown_velocity(self) -> Ned:
        """Velocity in {n}, NaN where there is no measurement."""
        north, east, down = self._shown("velocity", self.velocity_n)
        return north, east, down

    @property
    def shown_down(self) -> float:
        """Position's down, of a submarine its depth; NaN where there is no measurement."""
        there = self.depth is not None or "position" in self.begun
        return self.position_n[2] if there else math.nan

    def _shown(self, quantity: str, values: Sequence[float]) -> Sequence[float]:
        return values if quantity in self.begun else (math.nan,) * len(values)


@dataclass(frozen=True)
class Target:
    """A guided set-point: ``kind`` says which of the others apply. SI, rad, {n}."""

    kind: str
    """position, velocity or heading."""
    position: Ned = (0.0, 0.0, 0.0)
    velocity: Ned = (0.0, 0.0, 0.0)
    heading: float = 0.0
    speed: float = 0.0
    turn: float | None = None
    """Rate at which the heading turns, rad/s, and the position's down goes with the velocity's;
    None for a heading that stays."""
    expires: float | None = None
    """Simulated time at which it expires, s; None if it stays."""


@dataclass(frozen=True)
class StatusText:
    """STATUSTEXT for the ground stations."""

    severity: int
    text: str


@dataclass
class Vehicle:
    """State of the vehicle that services read and change. Times are simulated, s."""

    identity: Identity
    dialect: Dialect
    origin: Origin
    mode: Mode
    armed: bool = False
    home_n: Ned = (0.0, 0.0, 0.0)
    estimates: Estimates = field(default_factory=Estimates)
    receiver: Receiver = field(default_factory=Receiver)
    truth: Truth | None = None
    target: Target | None = None
    guided_speed: float = 0.0
    """Speed to guided positions that name none, m/s; 0 is the vehicle's own."""
    manual: tuple[float, float, float, float] = MANUAL_RELEASED
    """Surge, sway, yaw, heave, -1 to 1: ahead, to starboard, turn to starboard, down."""
    channels: list[int] = field(default_factory=lambda: [0] * 18)
    """RC channels as overridden, us; 0 is one that is not overridden."""
    failsafe: bool = False
    """Whether a failsafe acted, and what it was about still lasts."""
    fence_breached: bool = False
    """Whether it is where its fence does not allow it."""
    stations: int = 0
    """Number of ground stations that are there."""
    healthy: bool = False
    """Whether all arming checks pass."""
    capabilities: int = 0
    """MAV_PROTOCOL_CAPABILITY, of all services together."""
    paused_s: float = 0.0
    """Wall time that it stood still, s."""
    now: float = 0.0
    """Time of the simulation, s."""
    order: str = ""
    """Time of the last order that changed something, then the order."""
    texts: list[StatusText] = field(default_factory=list)
    """Status texts still to be sent."""

    def report(self, severity: int, text: str) -> None:
        """Send a status text to all ground stations, at the end of this instant."""
        self.texts.append(StatusText(severity, text))

    def ordered(self, what: str, content: object) -> None:
        """Note an order of a station, unless it repeats the one before."""
        order = f"{what} {content}"
        if self.order.partition(" ")[2] != order:
            self.order = f"{self.now!r} {order}"

    def link_time(self, now: float) -> float:
        """Return the time that protocols live by, s: simulated, and in pauses wall time."""
        return now + self.paused_s

    def enter(self, mode: Mode) -> None:
        """Change the mode; set-points and speeds of the one before no longer apply."""
        if mode != self.mode:
            self.mode, self.target, self.guided_speed = mode, None, 0.0
