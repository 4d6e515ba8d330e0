"""Inputs that a log feeds, and signals that are compared with it, as a person writes them."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.errors import InputError
from seatrial.fmi.components.table import RESERVED
from seatrial.trial.logs.channels import Log
from seatrial.trial.logs.quantities import Column, defaults

from ..paired.common_time import Window
from ..paired.pairing import Match
from ..paired.resampling import Trace, served
from ..played import found_in

YAW, SPEED, HELM = "yaw", "speed", "helm"
"""Orders to a vehicle's pilot: shares of full ones; the helm is an angle, to starboard."""
FULL_HELM = math.radians(35.0)
"""Helm, rad, that is full deflection in a log."""
MOTION = (
    *("north", "east", "depth", "roll", "pitch", "heading"),
    *("yaw_rate", "speed", "latitude", "longitude"),
)
"""Quantities of a log that are played beside, where it has them."""


@dataclass(frozen=True)
class Fed:
    """An input of the system, and the channel, or the constant, that feeds it."""

    port: str
    column: Column | None
    constant: float = 0.0


@dataclass(frozen=True)
class Asked:
    """What a person asks of a shadow."""

    feeds: Sequence[Fed]
    compared: Sequence[Match]
    columns: Mapping[str, Column]
    window: Window


@dataclass(frozen=True, eq=False)
class Traces:
    """What of a log is played: outputs of the component ``log`` by name."""

    outputs: Mapping[str, Trace]
    feeds: Mapping[str, str]
    """Output by the input that it feeds."""
    compared: Mapping[str, str]
    """Output by the signal that it is compared with, of those that were named."""
    motion: Mapping[str, str]
    """Output by the quantity that it is."""

    def orders(self) -> dict[str, str]:
        """Return outputs by the orders to a vehicle's pilot that they are."""
        return {port: name for port, name in self.feeds.items() if port in (YAW, SPEED)}


def read_feeds(texts: Sequence[str]) -> list[Fed]:
    """Return what texts PORT=CHANNEL, PORT=CHANNEL:UNIT or PORT=NUMBER say, several with commas.

    Raises InputError for another form, and for an input that is named twice.
    """
    found: list[Fed] = []
    for part in (part.strip() for text in texts for part in text.split(",")):
        port, equals, written = part.partition("=")
        name, colon, unit = written.partition(":")
        if not (port and equals and name) or (colon and not unit):
            raise InputError(
                f"--feed: PORT=CHANNEL, PORT=CHANNEL:UNIT or PORT=NUMBER is needed, found {part!r}"
            )
        if any(port == each.port for each in found):
            raise InputError(f"--feed: {port} is named twice")
        try:
            found.append(Fed(port, None, float(written)))
        except ValueError:
            found.append(Fed(port, Column(name, unit or None)))
    return found


def traces_of(log: Log, asked: Asked, *, has_pilot: bool) -> Traces:
    """Return what of a log is played.

    A helm of a vehicle with a pilot becomes the order `YAW`: its share of 35 deg, held to 1. Raises
    InputError for a channel or quantity that there is not, and units that do not fit.
    """
    outputs: dict[str, Trace] = {}
    feeds, compared = {}, {}
    for fed in _with_helm(log, asked, has_pilot=has_pilot):
        each = _fed(log, fed)
        port = YAW if fed.port == HELM else fed.port
        feeds[port] = _added(outputs, _name(fed), each)
    for match in asked.compared:
        each = found_in(log, match.column)
        compared[match.signal] = _added(outputs, _identifier(match.column.name), each)
    motion = {}
    of_log = {**defaults(log), **asked.columns}
    for what in MOTION:
        found = served(log, what, of_log[what]) if what in of_log else None
        if found is not None:
            motion[what] = _added(outputs, what, found)
    if not {"north", "east"} <= motion.keys() and {"latitude", "longitude"} <= motion.keys():
        for what in ("north", "east"):
            motion[what] = _added(outputs, what, found_in(log, Column(what)))
    if not outputs:
        raise InputError(
            f"{log.path}: nothing of it is fed or compared: --feed PORT=CHANNEL, --compare "
            "SIGNAL=CHANNEL"
        )
    return Traces(outputs, feeds, compared, motion)


def _with_helm(log: Log, asked: Asked, *, has_pilot: bool) -> list[Fed]:
    """Return the feeds, with the log's helm where a pilot is steered by nothing else."""
    feeds = list(asked.feeds)
    steered = {YAW, HELM} & {fed.port for fed in feeds}
    helm = {**defaults(log), **asked.columns}.get(HELM)
    if has_pilot and not steered and helm is not None:
        feeds.append(Fed(HELM, helm))
    return feeds


def _fed(log: Log, fed: Fed) -> Trace:
    if fed.column is None:
        times = [each.time for each in log.channels.values() if len(each.time)]
        ends = np.array([min(t[0] for t in times), max(t[-1] for t in times)])
        return Trace(fed.port, "1", ends, np.full(2, fed.constant), True, np.inf)
    if fed.port != HELM:
        return found_in(log, fed.column)
    helm = served(log, HELM, fed.column)
    assert helm is not None
    shares = np.clip(helm.values / FULL_HELM, -1.0, 1.0)
    return Trace(YAW, "1", helm.time, shares, helm.held, helm.gap)


def _name(fed: Fed) -> str:
    if fed.column is None or fed.port == HELM:
        return _identifier(YAW if fed.port == HELM else fed.port)
    return _identifier(fed.column.name)


def _identifier(name: str) -> str:
    found = re.sub(r"\W+", "_", name).strip("_")
    found = found if found[:1].isalpha() else f"c_{found}"
    return f"{found}_" if found in RESERVED else found


def _added(outputs: dict[str, Trace], name: str, each: Trace) -> str:
    """Add an output under a name that is its own; return the name. The same one is added once."""
    number, free = 1, name
    while free in outputs:
        other = outputs[free]
        if (
            other.unit == each.unit
            and np.array_equal(other.time, each.time)
            and np.array_equal(other.values, each.values)
        ):
            return free
        number += 1
        free = f"{name}_{number}"
    outputs[free] = each
    return free
