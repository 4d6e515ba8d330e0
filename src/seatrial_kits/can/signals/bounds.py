"""Bounds of a DBC, checked before cantools makes messages of it.

cantools takes time and memory by the numbers in a file, whatever its size: a list of the bits of
each message and signal, a codec for each value of each multiplexer (and, where multiplexers are
nested, for each combination), integers of as many digits as an exponent says. So its tokens are
looked at first, which are as many as the file has.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice, takewhile
from typing import Any

from cantools.database.can.formats.dbc.dbc_loader import DbcParser

from seatrial.errors import InputError

LARGEST = 4 * 2**20
"""Bytes of a file; cantools reads some 400 kB in a second."""
LONGEST_MESSAGE = 1785
"""Bytes: what J1939-21's transport protocol carries; CAN FD's longest frame has 64."""
LONGEST_TOKEN = 255
"""Characters of a name or number; the format's names have 32."""
MOST_SENDERS = 256
"""Of a message."""
MOST_WORK = 20_000_000
"""Sum over all signals of the bits of their message, for each value of the multiplexers that have
them; files of whole vehicles come to some millions."""
_LARGEST_IDENTIFIER = 2**32 - 1


@dataclass
class _Signal:
    """A signal as far as it takes time: its multiplexers, and how many values of them have it."""

    is_multiplexer: bool = False
    is_marked: bool = False
    above: set[str] = field(default_factory=set)
    values: int = 0


@dataclass
class _Message:
    name: str
    length: int
    signals: dict[str, _Signal] = field(default_factory=dict)


def check_bounds(text: str) -> None:
    """Raise InputError, with the line, for a DBC with numbers beyond any bus.

    Raises what cantools' own tokenizer raises, for what is no DBC.
    """
    _Reader(text).check()


class _Reader:
    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens: list[Any] = DbcParser().tokenize(text)  # of textparser, kind, value, offset
        self._messages: dict[int, _Message] = {}

    def check(self) -> None:
        message = None
        senders: Counter[int] = Counter()
        values: Counter[tuple[int, str]] = Counter()
        for token in self._tokens:
            self._check_token(token)
        for place, token in enumerate(self._tokens):
            if token.kind == "BO_" and self._is(place, "NUMBER WORD : NUMBER"):
                message = self._message(place)
            elif token.kind == "SG_" and message is not None:
                if self._is(place, "WORD : NUMBER | NUMBER"):
                    self._add_signal(message, place, [])
                elif self._is(place, "WORD WORD : NUMBER | NUMBER"):
                    self._add_signal(message, place + 1, [self._tokens[place + 2].value])
            elif token.kind == "BO_TX_BU_" and self._is(place, "NUMBER :"):
                identifier = self._whole(place + 1, 0, _LARGEST_IDENTIFIER, "identifier")
                senders[identifier] += len(self._until_end(place))
                if senders[identifier] > 2 * MOST_SENDERS:
                    raise self._error(place, f"a message has more than {MOST_SENDERS} senders")
            elif token.kind == "VAL_" and self._is(place, "NUMBER WORD"):
                identifier = self._whole(place + 1, 0, _LARGEST_IDENTIFIER, "identifier")
                values[identifier, self._tokens[place + 2].value] += len(self._until_end(place))
        for place, token in enumerate(self._tokens):  # they may come before their message
            if token.kind == "SG_MUL_VAL_" and self._is(place, "NUMBER WORD WORD"):
                self._add_multiplexer_values(place)
        self._check_work(values)

    # ------------------------------------------------------------------ inside

    def _check_token(self, token: Any) -> None:
        if token.kind not in ("NUMBER", "WORD"):
            return
        if len(token.value) > LONGEST_TOKEN:
            what = "number" if token.kind == "NUMBER" else "name"
            found = f"a {what} of {len(token.value)} characters"
            raise self._error(token, f"{found}, at most {LONGEST_TOKEN} are read")
        if token.kind == "NUMBER" and not math.isfinite(float(token.value)):
            raise self._error(token, f"the number {token.value} is beyond what a computer holds")

    def _message(self, place: int) -> _Message:
        identifier = self._whole(place + 1, 0, _LARGEST_IDENTIFIER, "identifier")
        name = self._tokens[place + 2].value
        length = self._whole(place + 4, 0, LONGEST_MESSAGE, f"length of message {name}, in bytes,")
        other = self._messages.setdefault(identifier, message := _Message(name, length))
        if other is not message:
            raise self._error(
                place,
                f"messages {other.name} and {name} have one identifier, "
                f"0x{identifier & 0x7FFFFFFF:X}",
            )
        return message

    def _add_signal(self, message: _Message, place: int, marks: Sequence[str]) -> None:
        """Add a signal; ``place`` is before its colon."""
        bits, mark = 8 * LONGEST_MESSAGE, marks[0] if marks else ""
        name = self._tokens[place + (0 if marks else 1)].value
        self._whole(place + 3, 0, bits - 1, f"start bit of signal {name}")
        self._whole(place + 5, 1, bits, f"length of signal {name}, in bits,")
        signal = message.signals.setdefault(name, _Signal())
        signal.is_multiplexer |= mark.endswith("M")
        signal.is_marked |= bool(mark)
        signal.values += 1

    def _add_multiplexer_values(self, place: int) -> None:
        identifier = self._whole(place + 1, 0, _LARGEST_IDENTIFIER, "identifier")
        name, above = self._tokens[place + 2].value, self._tokens[place + 3].value
        message = self._messages.get(identifier)
        numbers = [t for t in self._until_end(place + 3) if t.kind == "NUMBER"]
        count = 0
        for low, high in zip(numbers[::2], numbers[1::2], strict=False):
            first, last = _integer(low.value), _integer(high.value[1:])  # 1-3 is 1 and -3
            count += max(0, last - first + 1)
        if count > MOST_WORK // 8:
            raise self._error(place, f"signal {name} is there for {count} values of {above}")
        if message is not None and name in message.signals:
            message.signals[name].above.add(above)
            message.signals[name].values += count

    def _check_work(self, values: Counter[tuple[int, str]]) -> None:
        work = 0
        for identifier, message in self._messages.items():
            multiplexers = [name for name, s in message.signals.items() if s.is_multiplexer]
            if len(multiplexers) == 1:  # it has all that are marked
                for name, signal in message.signals.items():
                    if signal.is_marked and name != multiplexers[0]:
                        signal.above.add(multiplexers[0])
            codecs = 0
            for name, signal in message.signals.items():
                times = self._times(message, name, ())
                codecs += times * (1 + signal.is_multiplexer * values[identifier, name])
            work += codecs * (8 * message.length + 64)
            if work > MOST_WORK:
                raise InputError(
                    f"message {message.name}: with it, signals times bits times values of "
                    f"multiplexers are {work}, at most {MOST_WORK} are read"
                )

    def _times(self, message: _Message, name: str, below: tuple[str, ...]) -> int:
        """Return how many codecs a signal is part of."""
        if name in below:
            raise InputError(f"message {message.name}: {name} is a multiplexer of itself")
        if len(below) > 8:
            raise InputError(f"message {message.name}: multiplexers are more than 8 deep at {name}")
        signal = message.signals[name]
        above = [m for m in signal.above if m in message.signals]
        return signal.values * (
            sum(self._times(message, m, (*below, name)) for m in above) if above else 1
        )

    def _is(self, place: int, kinds: str) -> bool:
        """Say if the tokens after a place are of these kinds."""
        found = self._tokens[place + 1 : place + 1 + len(kinds.split())]
        return [token.kind for token in found] == kinds.split()

    def _until_end(self, place: int) -> list[Any]:
        """Return the tokens after a place to the next semicolon or keyword."""
        rest = islice(self._tokens, place + 1, None)
        return [*takewhile(lambda token: token.kind != ";" and token.kind[-1] != "_", rest)]

    def _whole(self, place: int, least: int, most: int, what: str) -> int:
        value = _integer(self._tokens[place].value)
        if not least <= value <= most:
            raise self._error(place, f"the {what} is {value}, allowed {least} to {most}")
        return value

    def _error(self, place: Any, message: str) -> InputError:
        token = self._tokens[place] if isinstance(place, int) else place
        return InputError(f"line {self._text.count(chr(10), 0, token.offset) + 1}: {message}")


def _integer(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise InputError(f"{text[:40]} is no whole number") from None
