"""AIS messages as bytes on the air and as VDM and VDO sentences, and back, by pyais."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from pyais import decode
from pyais.encode import ais_to_nmea_0183, data_to_payload
from pyais.exceptions import AISBaseException
from pyais.util import SixBitNibleEncoder

from .station import Fields

VDM, VDO = "VDM", "VDO"
"""What was received, and what the own station sends."""
_REFUSALS = (AISBaseException, ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
_MOST_PARTS = 10
"""Messages whose parts are waited for: there are ten numbers."""
_ENDING = re.compile(rb"[0-5]\*[0-9A-Fa-f]{2}")
"""Bits that fill up the last character, and the checksum."""
_CHARACTERS = range(ord("0"), ord("w") + 1)


def to_air(fields: Fields) -> bytes:
    """Return the bits of a message; ``fields`` by pyais's names, with ``msg_type``."""
    data, _ = data_to_payload(fields["msg_type"], fields).to_bytes()
    return bytes(data)


def sentences(data: bytes, kind: str, number: int = 0) -> list[bytes]:
    """Return the sentences of a message as it was on the air, with their ends of line.

    ``kind`` is `VDM` or `VDO`; ``number``, 0 to 9, goes with the parts of a long message. The
    channel is A: both are one here.
    """
    armoured, fill = SixBitNibleEncoder().encode(data, 8 * len(data))
    made = ais_to_nmea_0183(armoured, "AI", kind, "A", fill, seq_id=number)
    return [f"{each}\r\n".encode("ascii") for each in made]


@lru_cache(256)  # what a channel carries is read by many
def read(*parts: bytes) -> Fields | None:
    """Return the fields of a message from its sentences, None for what is none."""
    try:
        found: dict[str, Any] = decode(*parts, error_if_checksum_invalid=True).asdict()
    except _REFUSALS:
        return None
    return found


@dataclass
class Assembly:
    """Collects the parts of messages; ``waiting`` is plain data, the caller's."""

    waiting: dict[str, list[str]] = field(default_factory=dict)

    def take(self, line: bytes) -> tuple[Fields, bool] | None:
        """Return a message that a sentence completes, and whether it is the own station's.

        None while parts are missing, and for what is no VDM or VDO.
        """
        words = line.strip().split(b",")
        if len(words) != 7 or words[0][3:] not in (b"VDM", b"VDO") or words[0][:1] != b"!":
            return None
        if not _ENDING.fullmatch(words[6]):  # pyais reads what is no checksum as one
            return None
        if not words[5] or any(each not in _CHARACTERS for each in words[5]):
            return None
        own = words[0][3:] == b"VDO"
        whole = self._whole(words, line.strip().decode("latin-1"))
        found = None if whole is None else read(*(part.encode("latin-1") for part in whole))
        return None if found is None else (found, own)

    def _whole(self, words: list[bytes], text: str) -> list[str] | None:
        count, number = words[1], words[2]
        if count == b"1":
            return [text]
        if len(count) != 1:  # a message has up to nine parts
            return None
        key = b",".join((words[0], count, words[3], words[4])).decode("latin-1")
        parts = self.waiting.setdefault(key, [])
        if number != str(len(parts) + 1).encode():
            parts.clear()
        if number == str(len(parts) + 1).encode():
            parts.append(text)
        if count == str(len(parts)).encode() or not parts:
            return self.waiting.pop(key) or None
        while len(self.waiting) > _MOST_PARTS:
            self.waiting.pop(next(iter(self.waiting)))
        return None
