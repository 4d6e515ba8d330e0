"""MAVLink codec of one peer: bytes to messages and back."""

from __future__ import annotations

from typing import Any

from pymavlink.dialects.v20 import all as mavlink

from .signing import UNIT_S, Signing

Message = Any
"""A message of pymavlink: its fields are attributes."""

UNSIGNED = frozenset({mavlink.MAVLINK_MSG_ID_RADIO_STATUS})
"""Messages that are received without a signature: of a radio, which has no key."""

_AHEAD_S = 5.0
_MOST_SENDERS = 64
_LONGEST_REST = 1 << 13


class Codec:
    """MAVLink 2 to and from one peer: a sequence, a parser and counters of its own.

    MAVLink 1 is understood, MAVLink 2 is sent. Without ``signing`` every frame with a good
    checksum comes through; with it, signed ones alone and those of `UNSIGNED`.
    """

    def __init__(
        self, system: int, component: int, link_id: int = 0, signing: Signing | None = None
    ) -> None:
        self._mav = _Parser(system, component, signing)
        self._link_id = link_id % 256
        self._sequences: dict[tuple[int, int], int] = {}
        self.bad = 0
        """Frames and runs of bytes that were no message."""
        self.refused = 0
        """Frames whose signature was missing, wrong or old."""
        self.lost = 0
        """Frames that are missing in their sender's sequence."""
        self.duplicated = 0
        """Frames with the number of the one before."""

    @property
    def unusable(self) -> int:
        """Frames and runs of bytes of which nothing came through."""
        return self.bad + self.refused

    def encode(self, message: Message) -> bytes:
        """Return a message as the next frame of the sequence."""
        if self._mav.guard is not None:
            self._mav.guard.link_id = self._link_id
            self._mav.guard.tick()
        frame: bytes = message.pack(self._mav)
        self._mav.seq = (self._mav.seq + 1) % 256
        return frame

    def encode_last(self, message: Message) -> bytes:
        """Return a message as the frame that is still good if nothing follows for a while.

        It takes no number of the sequence; its timestamp is ahead, so that it is no repetition.
        """
        guard = self._mav.guard
        if guard is None:
            return bytes(message.pack(self._mav))
        guard.link_id = self._link_id
        guard.tick()
        now = guard.timestamp
        guard.timestamp += round(_AHEAD_S / UNIT_S)
        try:
            return bytes(message.pack(self._mav))
        finally:
            guard.timestamp = now

    def decode(self, data: bytes) -> list[Message]:
        """Return the messages that are complete with ``data``; the rest waits for more."""
        found = []
        for message in self._mav.parse_buffer(data) or ():
            kind = message.get_type()
            if kind == "BAD_DATA":
                if message.reason == "Invalid signature":
                    self.refused += 1
                else:
                    self.bad += 1
            elif not kind.startswith("UNKNOWN"):
                self._count(message)
                found.append(message)
        self._mav.forget_parsed()
        return found

    def _count(self, message: Message) -> None:
        sender = (message.get_srcSystem(), message.get_srcComponent())
        last = self._sequences.pop(sender, None)
        if last is not None:
            ahead = (message.get_seq() - last) % 256
            self.duplicated += ahead == 0
            # Half a circle ahead is rather a sender that began anew than so many lost frames.
            self.lost += ahead - 1 if 0 < ahead < 128 else 0
        elif len(self._sequences) >= _MOST_SENDERS:
            del self._sequences[next(iter(self._sequences))]
        self._sequences[sender] = message.get_seq()


class _Parser(mavlink.MAVLink):  # type: ignore[misc]
    """pymavlink's parser, with signatures checked by `Signing`."""

    buf: bytearray
    buf_index: int

    def __init__(self, system: int, component: int, guard: Signing | None) -> None:
        super().__init__(None, system, component)
        self.robust_parsing = True
        self.guard = guard
        self._forged = False
        if guard is not None:
            self.signing = guard
            guard.allow_unsigned_callback = _allowed_unsigned

    def check_signature(self, msgbuf: bytearray, srcSystem: int, srcComponent: int) -> bool:
        """Return whether the signature holds."""
        assert self.guard is not None
        genuine = self.guard.accepts(bytes(msgbuf), srcSystem, srcComponent)
        self._forged = not genuine
        return genuine

    def was_forged(self) -> bool:
        """Return whether the frame being parsed has a signature that does not hold."""
        forged, self._forged = self._forged, False
        return forged

    def forget_parsed(self) -> None:
        """Free what has been parsed: pymavlink does so only when nothing is left."""
        if self.buf_index > _LONGEST_REST:
            del self.buf[: self.buf_index]
            self.buf_index = 0


def _allowed_unsigned(parser: _Parser, message_id: int) -> bool:
    return not parser.was_forged() and message_id in UNSIGNED
