"""A DBC file, read by cantools, and what must hold for it to be used."""

from __future__ import annotations

import logging
from collections.abc import Collection
from pathlib import Path
from typing import Any

import cantools.database
from cantools.database.can import Database, Message, Signal
from cantools.database.errors import Error

from seatrial.errors import InputError, unknown

from ..frame import FD_LENGTHS
from .bounds import LARGEST, check_bounds
from .excerpt import excerpt

SHORTEST_MS = 0.047
"""A frame of CAN is 47 bits at the least: at 1 Mbit/s."""
_LONGEST_REASON = 500


def read_database(path: Path, wanted: Collection[str] | None = None) -> Database:
    """Return the messages of a DBC file; of ``wanted`` alone, by name, whatever the others are.

    Raises InputError, with the file, if it cannot be read, is no DBC, has numbers beyond any bus
    (`bounds`), two messages with one identifier, or not one of ``wanted`` (near misses).
    """
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    return database_of(data, str(path), wanted)


def database_of(data: bytes, called: str, wanted: Collection[str] | None = None) -> Database:
    """Return the messages of a DBC; as `read_database`, which names the file ``called``."""
    if len(data) > LARGEST:
        raise InputError(f"{called}: a DBC of more than {LARGEST} bytes, which is not read")
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = data.decode("cp1252", "replace")  # what the format's own tools write
    # What it warns of is refused where it matters.
    logging.getLogger("cantools.database.can.database").setLevel(logging.ERROR)
    try:
        if wanted is not None:
            text = excerpt(text, wanted)
            if not text.strip():
                return Database()
        check_bounds(text)
        found = cantools.database.load_string(text, "dbc", strict=False)
    except InputError as error:
        raise InputError(f"{called}: {error}") from None
    except Exception as error:  # it lets errors of its parser's parts through as they are
        reason = str(error).replace("DBC: ", "").strip('"') or type(error).__name__
        raise InputError(f"{called}: not a usable DBC: {reason[:_LONGEST_REASON]}") from None
    assert isinstance(found, Database)
    return found


def find_signal(path: Path, database: Database, name: str) -> tuple[Message, Signal]:
    """Return the message and signal that ``MESSAGE.SIGNAL`` names.

    Raises InputError with near misses, and for a message whose signals overlap or do not fit it,
    or whose cycle time is none.
    """
    message_name, _, signal_name = name.partition(".")
    messages = {message.name: message for message in database.messages}
    if message_name not in messages:
        raise InputError(f"{path}: {unknown('message', message_name, messages)}")
    message = messages[message_name]
    signals = {signal.name: signal for signal in message.signals}
    if signal_name not in signals:
        raise InputError(f"{path}: {unknown(f'signal of {message_name}', signal_name, signals)}")
    _check_message(path, message)
    return message, signals[signal_name]


def identifier_of(message: Message) -> tuple[int, bool]:
    """Return a message's identifier, and whether it has 29 bits."""
    return message.frame_id, message.is_extended_frame


def raw_range(signal: Signal) -> tuple[float, float]:
    """Return the least and greatest number that the bits of a signal can have, without scaling."""
    if signal.is_float:
        most = {16: 65504.0, 32: 3.4028234663852886e38}.get(signal.length, 1.7976931348623157e308)
        return -most, most
    if signal.is_signed:
        return -(1 << (signal.length - 1)), (1 << (signal.length - 1)) - 1
    return 0, (1 << signal.length) - 1


def _check_message(path: Path, message: Message) -> None:
    where = f"{path}: message {message.name}"
    try:
        message.refresh(strict=True)
    except Error as error:
        raise InputError(f"{where}: {error}") from None
    cycle: Any = message.cycle_time  # of whatever type the file says that it has
    if cycle is not None and not (isinstance(cycle, (int, float)) and SHORTEST_MS <= cycle <= 1e9):
        raise InputError(
            f"{where}: GenMsgCycleTime is {cycle!r}, allowed are 0 and {SHORTEST_MS} to 1e9 ms"
        )
    longest = FD_LENGTHS[-1] if message.is_fd else 8
    if message.length > longest:
        raise InputError(f"{where} has {message.length} bytes, a frame of it {longest} at most")
    for signal in message.signals:
        least, most = raw_range(signal)
        if signal.raw_initial is not None and not least <= signal.raw_initial <= most:
            raise InputError(
                f"{where}: {signal.name} has GenSigStartValue {signal.raw_initial:g}, its "
                f"{signal.length} bits hold {least} to {most}"
            )
