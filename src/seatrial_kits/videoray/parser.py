"""Frames out of a stream of bytes that may be broken anywhere."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from .frame import EXTENDED, HEADER, PRO4, Dialect, Frame

Timed = tuple[int, Frame]
"""Time of a frame's last byte, ns, and the frame."""


class Parser:
    """Finds the frames in what a serial port receives, requests and responses of some dialects.

    After a wrong check it looks for the next sync from the byte after the last one's first, so
    that a frame inside or behind a broken one is found. A frame that does not go on for
    ``timeout_ns`` is given up in the same way: so a false length, of up to 64 kB, swallows no
    more than what comes without such a gap.

    ``checksum_errors`` counts wrong checks, ``broken_off`` frames given up, ``skipped`` bytes
    that belong to no frame, ``frames`` what was found.
    """

    def __init__(self, timeout_ns: int, dialects: Iterable[Dialect] = (PRO4,)) -> None:
        self._timeout_ns = timeout_ns
        self._syncs = {
            sync: (dialect, sync == dialect.response)
            for dialect in dialects
            for sync in (dialect.request, dialect.response)
        }
        self._buffer = bytearray()
        self._last_ns = 0
        self.frames = self.checksum_errors = self.broken_off = self.skipped = 0

    def feed(self, data: bytes, begin_ns: int, byte_ns: int = 0) -> list[Timed]:
        """Return the frames that ``data`` completes.

        Its first byte begins at ``begin_ns``, each takes ``byte_ns``; bytes that came all at once
        take none. A frame's time is that of the end of its last byte.
        """
        found = self.expire(begin_ns)
        before = len(self._buffer)
        self._buffer += data
        self._last_ns = begin_ns + len(data) * byte_ns
        taken = 0  # bytes of the buffer that are gone, for the place of those left
        while (step := self._next()) is not None:
            frame, used = step
            taken += used
            if frame is not None:
                own = max(taken - before, 0)
                found.append((begin_ns + own * byte_ns, frame))
        return found

    def expire(self, now_ns: int) -> list[Timed]:
        """Give up a frame that has not gone on for too long; return what was behind its head."""
        if not self._buffer or now_ns - self._last_ns <= self._timeout_ns:
            return []
        self.broken_off += 1
        found: list[Timed] = []
        while self._buffer:
            self._drop(1)
            while (step := self._next()) is not None:
                if step[0] is not None:
                    found.append((now_ns, step[0]))
        return found

    def saved(self) -> dict[str, Any]:
        """Return what it knows, as plain data."""
        counters = {name: getattr(self, name) for name in _COUNTERS}
        return {"buffer": self._buffer.hex(), "last_ns": self._last_ns, **counters}

    def restore(self, saved: dict[str, Any]) -> None:
        """Restore what `saved` returned."""
        self._buffer = bytearray.fromhex(saved["buffer"])
        self._last_ns = saved["last_ns"]
        for name in _COUNTERS:
            setattr(self, name, saved[name])

    def _next(self) -> tuple[Frame | None, int] | None:
        """Take a frame, or what cannot be one, and return it and its bytes; None to wait."""
        buffer = self._buffer
        skipped = self._to_sync()
        if len(buffer) < HEADER:
            return (None, skipped) if skipped else None
        dialect, is_response = self._syncs[bytes(buffer[:2])]
        end = HEADER
        if (ok := self._checked(0, end, dialect)) is not True:
            return self._wrong(skipped) if ok is False else self._waiting(skipped)
        place, length = end + dialect.check_length, buffer[5]
        if length == EXTENDED:
            if (ok := self._checked(place, place + 2, dialect)) is not True:
                return self._wrong(skipped) if ok is False else self._waiting(skipped)
            length = int.from_bytes(buffer[place : place + 2], "little")
            place += 2 + dialect.check_length
        end = place + length
        if (ok := self._checked(place, end, dialect)) is not True:
            return self._wrong(skipped) if ok is False else self._waiting(skipped)
        frame = Frame(is_response, buffer[2], buffer[3], buffer[4], bytes(buffer[place:end]))
        used = end + dialect.check_length
        del buffer[:used]
        self.frames += 1
        return frame, skipped + used

    def _checked(self, begin: int, end: int, dialect: Dialect) -> bool | None:
        """Return whether the check after a part is right; None if it is not there yet."""
        stop = end + dialect.check_length
        if len(self._buffer) < stop:
            return None
        return dialect.check(bytes(self._buffer[begin:end])) == self._buffer[end:stop]

    def _wrong(self, skipped: int) -> tuple[None, int]:
        self.checksum_errors += 1
        self._drop(1)
        return None, skipped + 1

    def _waiting(self, skipped: int) -> tuple[None, int] | None:
        return (None, skipped) if skipped else None

    def _drop(self, count: int) -> None:
        del self._buffer[:count]
        self.skipped += count

    def _to_sync(self) -> int:
        """Drop the bytes before the next sync, or before what may become one; return how many."""
        buffer = self._buffer
        places = [place for sync in self._syncs if (place := buffer.find(sync)) >= 0]
        if places:
            count = min(places)
        else:
            may_begin = bool(buffer) and any(buffer[-1] == sync[0] for sync in self._syncs)
            count = len(buffer) - may_begin
        if count:
            self._drop(count)
        return count


_COUNTERS = ("frames", "checksum_errors", "broken_off", "skipped")
