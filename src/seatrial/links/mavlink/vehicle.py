"""The vehicle as the services see it: what it measures, what it was told, who listens."""

from __future__ import annotations

from dataclasses import dataclass, field

from .geodesy import Ned, Origin
from .modes import Flavour, Mode

CHANNELS = 16
"""Servo outputs of a vehicle."""

STICKS_RELEASED = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Identity:
    """Who the vehicle is on a MAVLink network."""

    system: int
    component: int
    vehicle_type: int
    """MAV_TYPE."""
    submerged: bool
    firmware_version: str
    uid: int
    boot_unix_us: int
    """Unix time of the start of the run, us; simulated time counts from there."""


@dataclass(frozen=True)
class Estimates:
    """What the vehicle measures. SI, rad; {n} north-east-down, {b} bow-starboard-down."""

    position_n: Ned = (0.0, 0.0, 0.0)
    velocity_n: Ned = (0.0, 0.0, 0.0)
    position_valid: bool = False
    attitude: Ned = (0.0, 0.0, 0.0)
    """Euler angles ZYX: phi, theta, psi."""
    heading_valid: bool = True
    rates: Ned = (0.0, 0.0, 0.0)
    specific_force: Ned = (0.0, 0.0, -9.80665)
    pressure: float = 101325.0
    apparent_wind: tuple[float, float] | None = None
    """Speed, and direction it blows to from the bow, to starboard positive."""
    voltage: float | None = None
    current: float | None = None
    charge: float | None = None
    """Share of the battery that is left, 0 to 1."""
    pulses: tuple[float, ...] = (0.0,) * CHANNELS
    """Servo pulses; 0 is an output that is not used."""
    named: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Truth:
    """What the simulated vehicle really does. SI, rad; velocity in {n}, the rest in {b}."""

    position_n: Ned
    velocity_n: Ned
    attitude: Ned
    rates: Ned
    specific_force: Ned


@dataclass(frozen=True)
class Target:
    """A guided set-point: ``kind`` says which of the others count. SI, rad, {n}."""

    kind: str
    """position, velocity or heading."""
    position: Ned = (0.0, 0.0, 0.0)
    velocity: Ned = (0.0, 0.0, 0.0)
    heading: float = 0.0
    speed: float = 0.0
    expires: float | None = None
    """Simulated time at which it counts no longer, s; None if it stays."""


@dataclass(frozen=True)
class StatusText:
    """A sentence for the people at the ground stations."""

    severity: int
    text: str


@dataclass
class Vehicle:
    """State of the vehicle that services read and change. Times are simulated, s."""

    identity: Identity
    flavour: Flavour
    origin: Origin
    mode: Mode
    armed: bool = False
    home_n: Ned = (0.0, 0.0, 0.0)
    estimates: Estimates = field(default_factory=Estimates)
    truth: Truth | None = None
    target: Target | None = None
    sticks: tuple[float, float, float, float] = STICKS_RELEASED
    """Surge, sway, yaw, heave, -1 to 1: ahead, to starboard, turn to starboard, down."""
    channels: list[int] = field(default_factory=lambda: [0] * 18)
    """RC channels as overridden, us; 0 is one that nobody overrides."""
    failsafe: bool = False
    """Whether a failsafe acted, and what it was about still lasts."""
    fence_breached: bool = False
    """Whether it is where its fence does not allow it."""
    stations: int = 0
    """Number of ground stations that are there."""
    healthy: bool = False
    """Whether nothing speaks against arming."""
    capabilities: int = 0
    """MAV_PROTOCOL_CAPABILITY, of all services together."""
    texts: list[StatusText] = field(default_factory=list)
    """What is still to be said."""

    def say(self, severity: int, text: str) -> None:
        """Say something to all ground stations, at the end of this instant."""
        self.texts.append(StatusText(severity, text))

    def enter(self, mode: Mode) -> None:
        """Change the mode; set-points of the one before count no longer."""
        if mode != self.mode:
            self.mode, self.target = mode, None
