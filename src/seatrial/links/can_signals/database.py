"""A DBC file, read by cantools, and what must hold for it to be used."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from pathlib import Path

import cantools.database
from cantools.database.can import Database, Message, Signal

from ...errors import InputError, unknown


def read_database(path: Path) -> Database:
    """Return the messages of a DBC file.

    Raises InputError, with the file, if it cannot be read or is no DBC, if signals of a message
    overlap or do not fit it, and if two messages have one identifier.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = data.decode("cp1252", "replace")  # what the format's own tools write
    # What it warns of is refused below.
    logging.getLogger("cantools.database.can.database").setLevel(logging.ERROR)
    try:
        found = cantools.database.load_string(text, "dbc")
    except Exception as error:  # it lets errors of its parser's parts through as they are
        reason = str(error).replace("DBC: ", "").strip('"') or type(error).__name__
        raise InputError(f"{path}: not a usable DBC: {reason}") from None
    assert isinstance(found, Database)
    _check_identifiers(path, found.messages)
    return found


def find_signal(path: Path, database: Database, name: str) -> tuple[Message, Signal]:
    """Return the message and signal that ``MESSAGE.SIGNAL`` names.

    Raises InputError with near misses.
    """
    message_name, _, signal_name = name.partition(".")
    messages = {message.name: message for message in database.messages}
    if message_name not in messages:
        raise InputError(f"{path}: {unknown('message', message_name, messages)}")
    message = messages[message_name]
    signals = {signal.name: signal for signal in message.signals}
    if signal_name not in signals:
        raise InputError(f"{path}: {unknown(f'signal of {message_name}', signal_name, signals)}")
    return message, signals[signal_name]


def identifier_of(message: Message) -> tuple[int, bool]:
    """Return a message's identifier, and whether it has 29 bits."""
    return message.frame_id, message.is_extended_frame


def _check_identifiers(path: Path, messages: Iterable[Message]) -> None:
    known: dict[tuple[int, bool], str] = {}
    for message in messages:
        other = known.setdefault(identifier_of(message), message.name)
        if other != message.name:
            raise InputError(
                f"{path}: messages {other} and {message.name} have one identifier, "
                f"0x{message.frame_id:X}"
            )
