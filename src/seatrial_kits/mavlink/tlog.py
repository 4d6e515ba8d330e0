"""Telemetry logs: all frames with their times, as ground stations keep and read them."""

from __future__ import annotations

from io import FileIO
from pathlib import Path

from seatrial.errors import SimulationError

from .scaling import microseconds


class TelemetryLog:
    """A .tlog: for each frame the Unix time, us, in 8 bytes, the highest first; then the frame.

    Time is simulated, counted from ``boot_unix_us``: two runs that receive the same leave the same
    file. What is written before it is opened is not kept; afterwards each frame is on disk when
    `write` returns. Raises SimulationError if the file is there already or cannot be written.
    """

    def __init__(self, boot_unix_us: int) -> None:
        self._boot = boot_unix_us
        self._file: FileIO | None = None
        self.now = 0.0
        """Simulated time of what is written next, s."""

    @property
    def is_open(self) -> bool:
        """Whether there is a file."""
        return self._file is not None

    @property
    def path(self) -> Path | None:
        """The file, None if there is none."""
        return None if self._file is None else Path(str(self._file.name))

    def open(self, path: Path) -> None:
        """Begin a file."""
        try:
            self._file = path.open("xb", buffering=0)
        except OSError as error:
            raise _failed(str(path), error) from None

    def write(self, frame: bytes) -> None:
        """Write a frame that was received or sent."""
        if self._file is None:
            return
        stamp = (self._boot + microseconds(self.now)).to_bytes(8, "big")
        try:
            self._file.write(stamp + bytes(frame))
        except OSError as error:
            raise _failed(self._file.name, error) from None

    def close(self) -> None:
        """Close the file; a new one may be opened."""
        if self._file is not None:
            self._file.close()
        self._file = None


def _failed(path: object, error: OSError) -> SimulationError:
    return SimulationError(f"cannot write the log {path}: {error.strerror}")
