"""The catalogue: every fault by its name, on what it acts, and the settings that it takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from ...plugins import Registry

On = Literal["signal", "stream", "device", "measurement", "bus", "component"]
"""An output, input or parameter; a text port of chunks; a device of ours; what a sensor of ours
measures; a node of our CAN bus; a component of any kind."""

Measure = Literal["value", "rate", "duration", "number", "probability", "coefficients", "range"]
"""value: in the unit of the port, or one for each of its axes; rate: that per second; coefficients:
five values; range: two."""


@dataclass(frozen=True)
class Setting:
    """A setting that a fault takes."""

    measure: Measure
    meaning: str
    default: float | None = None
    """A setting without it must be written."""


@dataclass(frozen=True)
class Kind:
    """A fault of the catalogue: y is what its readers get in the place of x."""

    title: str
    on: tuple[On, ...]
    equation: str
    settings: dict[str, Setting]
    grows: bool = False
    """Whether it takes ``grows_over``: its share s rises from 0 to 1 in that time."""
    make: Callable[..., Any] | None = None
    """Of a kit's fault of signals: its operator, of settings, index of the scalar, and numbers.

    Called as ``make(settings, index, draw)``, with `sim.fault_settings.Settings` and
    `operators.Draw`; returns an `operators.Operator`.
    """


_EVERY = Setting("duration", "new numbers come so often, counted from its begin", 0.1)
_WRAPS = {"wraps": Setting("range", "y is brought into this range by whole turns, as an angle", 0)}


def _level(meaning: str) -> Setting:
    return Setting("value", meaning)


SIGNALS = {
    "fixed": Kind(
        "one value, whatever was measured or commanded",
        ("signal",),
        "y = x + s (value − x)",
        {"value": _level("what it is; a text or a truth value too")},
        grows=True,
    ),
    "bias": Kind(
        "a constant error; with `grows_over` one that comes slowly",
        ("signal", "measurement"),
        "y = x + s value",
        {"value": _level("what is added"), **_WRAPS},
        grows=True,
    ),
    "drift": Kind(
        "an error that grows for ever: gyro drift, a spoofed position that walks off",
        ("signal", "measurement"),
        "y = x + rate (t − at)",
        {"rate": Setting("rate", "how fast the error grows"), **_WRAPS},
    ),
    "scale": Kind(
        "a wrong gain; loss of effectiveness of an actuator; −1 for reversed leads",
        ("signal", "measurement"),
        "y = x (1 + s (factor − 1))",
        {"factor": Setting("number", "by which it is multiplied")},
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
        "a compass beside iron or currents",
        ("signal", "measurement"),
        "y = x + s (A + B sin x + C cos x + D sin 2x + E cos 2x)",
        {"coefficients": Setting("coefficients", "A, B, C, D, E"), **_WRAPS},
        grows=True,
    ),
    "stuck": Kind(
        "the last value for ever: a frozen sensor, a jammed shaft",
        ("signal", "device"),
        "y = x(at)",
        {},
    ),
    "dropout": Kind(
        "values that do not come, so that the one before stays",
        ("signal",),
        "y = what it was in the interval before, with probability s p in interval i; else x",
        {"probability": Setting("probability", "p"), "every": _EVERY},
        grows=True,
    ),
    "garbage": Kind(
        "random values",
        ("signal", "device"),
        "y uniform from low to high, anew in each interval",
        {
            "low": Setting("value", "the least"),
            "high": Setting("value", "the greatest"),
            "every": _EVERY,
        },
    ),
    "delay": Kind(
        "values that come late",
        ("signal",),
        "y(t) = x(t − s time), x(at) before there is one",
        {"time": Setting("duration", "how late")},
        grows=True,
    ),
    "lag": Kind(
        "a slow sensor, a sluggish actuator",
        ("signal",),
        "time dy/dt = x − y, y(at) = x(at)",
        {"time": Setting("duration", "time constant")},
    ),
    "rate-limit": Kind(
        "an actuator that moves slowly",
        ("signal",),
        "|dy/dt| ≤ rate, y(at) = x(at)",
        {"rate": Setting("rate", "the fastest that it moves")},
    ),
    "limit": Kind(
        "a range that has become smaller: a stop, a derated drive",
        ("signal",),
        "y = min(max(x, low), high)",
        {"low": Setting("value", "the least"), "high": Setting("value", "the greatest")},
    ),
    "runaway": Kind(
        "an actuator that goes to its end, whatever is commanded",
        ("signal",),
        "y = x(at) ± rate (t − at) as far as value, and stays there",
        {"value": _level("where it ends"), "rate": Setting("rate", "how fast it goes there")},
    ),
    "nan": Kind("a computation that failed", ("signal", "component"), "y is not a number", {}),
}

STREAMS = {
    "loss": Kind(
        "packets, sentences or bytes that do not arrive; probability 1 is a broken link",
        ("stream",),
        "chunk k is lost with probability s p",
        {"probability": Setting("probability", "p", 1.0)},
        grows=True,
    ),
    "latency": Kind(
        "a slow link; with `jitter` one that is so unevenly",
        ("stream",),
        "chunk k comes s (time + jitter u_k) later, in its order",
        {
            "time": Setting("duration", "for all", 0.0),
            "jitter": Setting("duration", "the most that is added to it", 0.0),
        },
        grows=True,
    ),
    "reorder": Kind(
        "packets that others overtake",
        ("stream",),
        "chunk k comes `time` later than its order with probability s p",
        {"probability": Setting("probability", "p"), "time": Setting("duration", "how much later")},
        grows=True,
    ),
    "duplicate": Kind(
        "packets that come twice",
        ("stream",),
        "chunk k comes twice with probability s p",
        {"probability": Setting("probability", "p")},
        grows=True,
    ),
    "corruption": Kind(
        "noise on the line",
        ("stream",),
        "each bit is wrong with probability s p",
        {"probability": Setting("probability", "p, of a bit")},
        grows=True,
    ),
}

DEVICES = {
    "off": Kind(
        "no measurement, no command arrives; a node is out of the bus",
        ("device", "bus"),
        "`valid` is false, values stay; a thruster stops, a shaft stays where it is",
        {},
    ),
    "wrong": Kind(
        "a damaged device",
        ("device",),
        "a tenth of its span too much; half of the thrust; a tenth of its range off",
        {},
    ),
    "slow": Kind(
        "a slow device",
        ("device",),
        "every tenth measurement; a lag ten times as long, or a tenth of the rate",
        {},
    ),
    "delayed": Kind(
        "a late device", ("device",), "10 sample periods late; commands 0.5 s late", {}
    ),
    "intermittent": Kind(
        "a loose contact",
        ("device",),
        "each measurement, or commands in every 0.2 s, lost with probability ½",
        {},
    ),
    "babbling": Kind(
        "a node that never stops to send", ("bus",), "frames of identifier 0 without a pause", {}
    ),
    "defective": Kind(
        "a node with a broken transmitter, until it is bus-off",
        ("bus",),
        "each frame that it sends is broken",
        {},
    ),
}

COMPONENTS = {
    "hang": Kind(
        "a program that is stopped, and goes on",
        ("component",),
        "all outputs and connected inputs are x(at); nothing is sent or received",
        {},
    ),
    "crash": Kind(
        "a program that ends; after `for` it starts anew",
        ("component",),
        "as `hang`; with `for`, it starts then as at the start of the run",
        {},
    ),
    "power-loss": Kind(
        "no supply: brown-out and reset of a board; after `for` it starts anew",
        ("component",),
        "numbers are 0, switches false, nothing is sent or received; then as `crash`",
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
