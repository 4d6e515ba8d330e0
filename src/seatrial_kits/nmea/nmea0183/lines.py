"""Splitter of received bytes into sentences."""

from __future__ import annotations

_LONGEST = 1024
"""Bytes without an end of line after which they are none."""


class Lines:
    """Collects what one sender sends until there is a whole sentence.

    What stands before the ``$`` or ``!`` of a line (half a sentence, a tag block) is dropped.
    """

    def __init__(self, waiting: str = "") -> None:
        self.waiting = waiting
        """What has no end of line yet; text, so that it can be part of a component's state."""

    def take(self, data: bytes) -> list[bytes]:
        """Return the sentences that are whole now, without their ends of line."""
        *whole, self.waiting = (
            (self.waiting + data.decode("latin-1")).replace("\r", "\n").split("\n")
        )
        if len(self.waiting) > _LONGEST:
            self.waiting = ""
        return [found for line in whole if (found := _sentence(line))]


def _sentence(line: str) -> bytes:
    start = max(line.rfind("$"), line.rfind("!"))
    return line[start:].strip().encode("latin-1") if start >= 0 else line.strip().encode("latin-1")
