"""Channels: what is commanded over the bus, one port element each."""

from __future__ import annotations

import re
from typing import NamedTuple

from seatrial.errors import InputError

MOST_CHANNELS = 8
"""Channels of one node."""
AXES = tuple(f"c{number}" for number in range(1, MOST_CHANNELS + 1))
"""Names of their elements in ports."""

ACTUATOR_TYPES = ("unitless", "position", "force", "speed", "pwm")
"""Kinds of actuator commands, by their number on the bus."""

LARGEST_ESC, LARGEST_ACTUATOR = 19, 255

_CHANNEL = re.compile(r"(?P<what>esc|rpm|actuator)(?P<number>\d{1,3})(?::(?P<type>[a-z]+))?")


class Channel(NamedTuple):
    """One of a node's channels: ``kind`` is esc, rpm or an actuator's type."""

    kind: str
    number: int

    @property
    def is_esc(self) -> bool:
        """Whether its status is an ESC's."""
        return self.kind in ("esc", "rpm")


def channels_of(text: str) -> list[Channel]:
    """Return the channels that ``text`` names: ``esc0 rpm1 actuator2 actuator3:position``.

    Raises InputError for one that cannot be, twice the same, and more than there are ports.
    """
    found = [_channel(word) for word in text.split()]
    if len(found) > MOST_CHANNELS:
        raise InputError(f"channels has {len(found)} channels, {MOST_CHANNELS} at most")
    places = [(each.is_esc, each.number) for each in found]
    for place, word in zip(places, text.split(), strict=True):
        if places.count(place) > 1:
            raise InputError(f"channels: {word!r} has a number that another one has too")
    return found


def _channel(word: str) -> Channel:
    match = _CHANNEL.fullmatch(word)
    if match is None:
        raise InputError(
            f"channels: {word!r} is no channel, such as 'esc0', 'rpm0', 'actuator3' or "
            "'actuator3:position'"
        )
    what, number, kind = match["what"], int(match["number"]), match["type"]
    is_esc = what != "actuator"
    if is_esc and kind:
        raise InputError(f"channels: {word!r}: only actuators have a type")
    if kind is not None and kind not in ACTUATOR_TYPES:
        raise InputError(f"channels: {word!r}: the type is one of {', '.join(ACTUATOR_TYPES)}")
    largest = LARGEST_ESC if is_esc else LARGEST_ACTUATOR
    if number > largest:
        raise InputError(f"channels: {word!r}: the number is at most {largest}")
    return Channel(what if is_esc else kind or "unitless", number)
