"""The catalogue: each fault by its name, with its targets and its settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from ...plugins import Registry

On = Literal["signal", "stream", "device", "measurement", "bus", "component"]
"""An output, input or parameter; a text port of chunks; a device of ours; a measurement of a sensor
of ours; a node of our CAN bus; a component of any kind."""

Measure = Literal["value", "rate", "duration", "number", "probability", "coefficients", "range"]
"""value: in the unit of the port, or one for each of its axes; rate: that per second; coefficients:
five values; range: two."""


@dataclass(frozen=True)
class Setting:
    """A setting that a fault takes."""

    measure: Measure
    meaning: str
    default: float | None = None
    """A setting without a default is required."""


@dataclass(frozen=True)
class Kind:
    """A fault of the catalogue: its readers get y in place of x."""

    title: str
    on: tuple[On, ...]
    equation: str
    settings: dict[str, Setting]
    grows: bool = False
    """Whether the fault takes ``grows_over``, in which its share s rises from 0 to 1."""
    make: Callable[..., Any] | None = None
    """Operator of a kit's fault of signals, of settings, index of the scalar, and random numbers.

    Called as ``make(settings, index, draw)``, with `sim.fault_settings.Settings` and
    `operators.Draw`; returns an `operators.Operator`.
    """


_EVERY = Setting("duration", "interval of new random numbers, from `at`", 0.1)
_WRAPS = {"wraps": Setting("range", "y wraps into this range, as an angle", 0)}


def _level(meaning: str) -> Setting:
    return Setting("value", meaning)


SIGNALS = {
    "fixed": Kind(
        "a constant in place of the signal",
        ("signal",),
        "y = x + s (value − x)",
        {"value": _level("the constant; a text or a truth value too")},
        grows=True,
    ),
    "bias": Kind(
        "a constant error; with `grows_over` a ramp up to it",
        ("signal", "measurement"),
        "y = x + s value",
        {"value": _level("the added error"), **_WRAPS},
        grows=True,
    ),
    "drift": Kind(
        "an error that grows linearly: gyro drift, a spoofed position",
        ("signal", "measurement"),
        "y = x + rate (t − at)",
        {"rate": Setting("rate", "growth of the error"), **_WRAPS},
    ),
    "scale": Kind(
        "a wrong gain; loss of effectiveness of an actuator; −1 for reversed leads",
        ("signal", "measurement"),
        "y = x (1 + s (factor − 1))",
        {"factor": Setting("number", "the gain")},
        grows=True,
    ),
    "noise": Kind(
        "white noise",
        ("signal", "measurement"),
        "y = x + s value w_i, w_i standard normal in interval i",
        {"value": _level("standard deviation"), "every": _EVERY, **_WRAPS},
        grows=True,
    ),
    "deviation": Kind(
        "magnetic deviation of a compass",
        ("signal", "measurement"),
        "y = x + s (A + B sin x + C cos x + D sin 2x + E cos 2x)",
        {"coefficients": Setting("coefficients", "A, B, C, D, E"), **_WRAPS},
        grows=True,
    ),
    "stuck": Kind(
        "the last value, held: a frozen sensor, a jammed shaft",
        ("signal", "device"),
        "y = x(at)",
        {},
    ),
    "dropout": Kind(
        "lost values; readers keep the last one",
        ("signal",),
        "y = y of interval i − 1 with probability s p in interval i; else x",
        {"probability": Setting("probability", "p"), "every": _EVERY},
        grows=True,
    ),
    "garbage": Kind(
        "random values",
        ("signal", "device"),
        "y uniform in [low, high], drawn in each interval",
        {
            "low": Setting("value", "lower limit"),
            "high": Setting("value", "upper limit"),
            "every": _EVERY,
        },
    ),
    "delay": Kind(
        "late values",
        ("signal",),
        "y(t) = x(max(at, t − s time))",
        {"time": Setting("duration", "the delay")},
        grows=True,
    ),
    "lag": Kind(
        "a slow sensor, a sluggish actuator",
        ("signal",),
        "time dy/dt = x − y, y(at) = x(at)",
        {"time": Setting("duration", "time constant")},
    ),
    "rate-limit": Kind(
        "a slow actuator",
        ("signal",),
        "|dy/dt| ≤ rate, y(at) = x(at)",
        {"rate": Setting("rate", "the largest rate")},
    ),
    "limit": Kind(
        "a smaller range: a stop, a derated drive",
        ("signal",),
        "y = min(max(x, low), high)",
        {"low": Setting("value", "lower limit"), "high": Setting("value", "upper limit")},
    ),
    "runaway": Kind(
        "an actuator that runs to its end position against its command",
        ("signal",),
        "y = x(at) ± rate (t − at) up to value",
        {
            "value": _level("the end position"),
            "rate": Setting("rate", "rate towards the end position"),
        },
    ),
    "nan": Kind("a failed computation", ("signal", "component"), "y is not a number", {}),
}

STREAMS = {
    "loss": Kind(
        "lost packets, sentences or bytes; a broken link with probability 1",
        ("stream",),
        "chunk k is lost with probability s p",
        {"probability": Setting("probability", "p", 1.0)},
        grows=True,
    ),
    "latency": Kind(
        "a slow link, with `jitter` of random delay",
        ("stream",),
        "chunk k arrives s (time + jitter u_k) later, u_k uniform in [0, 1], in order",
        {
            "time": Setting("duration", "delay of each chunk", 0.0),
            "jitter": Setting("duration", "largest additional delay", 0.0),
        },
        grows=True,
    ),
    "reorder": Kind(
        "packets out of order",
        ("stream",),
        "chunk k arrives `time` later with probability s p; later chunks overtake it",
        {"probability": Setting("probability", "p"), "time": Setting("duration", "the delay")},
        grows=True,
    ),
    "duplicate": Kind(
        "duplicate packets",
        ("stream",),
        "chunk k arrives twice with probability s p",
        {"probability": Setting("probability", "p")},
        grows=True,
    ),
    "corruption": Kind(
        "bit errors",
        ("stream",),
        "each bit is inverted with probability s p",
        {"probability": Setting("probability", "p, for each bit")},
        grows=True,
    ),
}

DEVICES = {
    "off": Kind(
        "a device that is switched off; a node that has left the bus",
        ("device", "bus"),
        "`valid` is false and values stay; a thruster stops; a shaft keeps its position",
        {},
    ),
    "wrong": Kind(
        "a damaged device",
        ("device",),
        "a sensor reads 10 % of its span too high; a thruster gives half of its thrust; "
        "a shaft is 10 % of its range off",
        {},
    ),
    "slow": Kind(
        "a slow device",
        ("device",),
        "a sensor gives each tenth measurement; an actuator has ten times its lag, "
        "or a tenth of its rate",
        {},
    ),
    "delayed": Kind(
        "a late device", ("device",), "measurements are 10 sample periods late, commands 0.5 s", {}
    ),
    "intermittent": Kind(
        "a loose contact",
        ("device",),
        "each measurement, or the commands of each 0.2 s, are lost with probability ½",
        {},
    ),
    "babbling": Kind(
        "a node that sends without a pause", ("bus",), "frames of identifier 0 fill the bus", {}
    ),
    "defective": Kind(
        "a node with a broken transmitter; it becomes bus-off",
        ("bus",),
        "each frame of the node has an error",
        {},
    ),
}

COMPONENTS = {
    "hang": Kind(
        "a suspended program; after `for` it continues",
        ("component",),
        "outputs and connected inputs are x(at); no bytes are sent or received",
        {},
    ),
    "crash": Kind(
        "a crashed program; after `for` it restarts",
        ("component",),
        "as `hang`; the component then starts as at the start of the run",
        {},
    ),
    "power-loss": Kind(
        "brown-out and reset of a board; after `for` it restarts",
        ("component",),
        "numbers are 0, switches false, no bytes are sent or received; then as `crash`",
        {},
    ),
}

KINDS: dict[str, Kind] = {**SIGNALS, **STREAMS, **DEVICES, **COMPONENTS}
"""All faults of the core by their names."""
OF_KITS = Registry("seatrial.faults", "fault", {})
"""Faults of signals that kits add: each a `Kind` that makes its operator."""


def kinds() -> Mapping[str, Kind]:
    """Return all faults by their names, those of kits last. Raises InputError."""
    return {**KINDS, **{name: OF_KITS.load(name) for name in OF_KITS.names()}}


FAILURES = ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent")
"""Failures of a whole device: MAVLink's FAILURE_TYPE from 1, in its order."""
