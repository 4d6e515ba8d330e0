"""Message signing: authentication and replay protection of frames."""

from __future__ import annotations

import hashlib
import hmac
import time
from collections.abc import Callable
from pathlib import Path

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError

from .state_file import StateFile

UNIT_S = 1e-5
EPOCH = 1_420_070_400.0
"""Timestamps count 10 us from 2015-01-01, Unix time in s."""

_KEY = "signing_timestamp"
_MINUTE = round(60.0 / UNIT_S)
_SAVE_EVERY = round(10.0 / UNIT_S)


def read_key(path: Path) -> bytes:
    """Return the key that the pass phrase in ``path`` stands for: SHA-256 of its first line.

    Ground stations make the same key of the same pass phrase. Raises InputError for a file that
    cannot be read or has an empty first line.
    """
    try:
        phrase = path.read_text("utf-8").split("\n", 1)[0].strip("\r")
    except (OSError, UnicodeDecodeError) as error:
        cause = error.strerror if isinstance(error, OSError) else "not UTF-8"
        raise InputError(f"signing key file {path}: {cause}") from None
    if not phrase:
        raise InputError(f"signing key file {path}: its first line, the pass phrase, is empty")
    return hashlib.sha256(phrase.encode()).digest()


class Signing(mavlink.MAVLinkSigning):  # type: ignore[misc]
    """Key, clock and memory of a vehicle that signs, shared by all its links.

    A signed frame is accepted if its signature is SHA-256 of key and frame, and its timestamp
    is later than the last of the same (link, system, component); of one that was not received
    before, later than all of earlier runs and not more than a minute behind ours. Nothing is
    remembered of a frame whose signature is wrong: a forger could lock the owner out.

    ``clock`` is Unix time, s: the ground stations' own timestamps come from theirs. The newest
    timestamp is kept in ``state``.
    """

    def __init__(
        self, key: bytes, state: StateFile, clock: Callable[[], float] = time.time
    ) -> None:
        super().__init__()
        self.secret_key = key
        self.sign_outgoing = True
        self._clock, self._state = clock, state
        self._floor = int(state.get(_KEY, 0))
        self.timestamp = self._floor + 1
        self.tick()
        self.save()

    def tick(self) -> None:
        """Let the timestamp follow the clock, never backwards; keep it now and then."""
        self.timestamp = max(self.timestamp, round((self._clock() - EPOCH) / UNIT_S))
        if self.timestamp - int(self._state.get(_KEY, 0)) > _SAVE_EVERY:
            self.save()

    def save(self) -> None:
        """Keep the timestamp for the runs to come."""
        self._state.put(_KEY, self.timestamp)

    def accepts(self, frame: bytes, system: int, component: int) -> bool:
        """Return whether a signed frame is genuine and new, and remember it if so."""
        digest = hashlib.sha256(self.secret_key + frame[:-6]).digest()[:6]
        if not hmac.compare_digest(digest, frame[-6:]):
            return False
        self.tick()
        timestamp = int.from_bytes(frame[-12:-6], "little")
        stream = (frame[-13], system, component)
        last = self.stream_timestamps.get(stream)
        if last is None:
            last = max(self._floor, self.timestamp - _MINUTE)
        if timestamp <= last:
            return False
        self.stream_timestamps[stream] = timestamp
        self.timestamp = max(self.timestamp, timestamp)
        return True
