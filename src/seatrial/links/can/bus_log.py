"""Bus logs in the formats of common tools."""

from __future__ import annotations

import contextlib
from pathlib import Path

import can

from ...errors import SimulationError
from .frame import Frame
from .messages import error_message, message
from .operations import Error


class BusLog:
    """``NAME.blf`` (Vector's binary log) and ``NAME.log`` (as candump -L writes it).

    One entry for each frame and error frame, when it ended: simulated time, which is counted
    from 0; to the nanosecond in the first, to the microsecond in the second. The same entries
    leave the same bytes. The second has no length of what remote frames request, and of error
    frames no class. Lines of the second are on disk at once, blocks of the first
    each 128 kB, and at the end.

    Raises SimulationError if a file is there already or cannot be written.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self._name = name
        with contextlib.ExitStack() as opened:
            try:
                blf = opened.enter_context((folder / f"{name}.blf").open("xb"))
                text = opened.enter_context(
                    (folder / f"{name}.log").open("x", 1, "utf-8", newline="\n")
                )
            except OSError as error:
                raise self._failed(error) from None
            opened.pop_all()
        self._blf, self._text = can.BLFWriter(blf), can.CanutilsLogWriter(text)
        # Else times would be counted from the first frame: the format keeps dates after 1990 only.
        self._blf.start_timestamp = 0.0

    def frame(self, time_ns: int, frame: Frame) -> None:
        """Write a frame that ended then."""
        self._write(message(frame, _seconds(time_ns), self._name))

    def error(self, time_ns: int, error: Error) -> None:
        """Write an error frame that ended then."""
        self._write(error_message(error, _seconds(time_ns), self._name))

    def close(self) -> None:
        """Write what is left."""
        try:
            self._blf.stop()
            self._text.stop()
        except OSError as error:
            raise self._failed(error) from None

    def _write(self, entry: can.Message) -> None:
        try:
            self._text.on_message_received(entry)
            entry.channel = None
            self._blf.on_message_received(entry)
        except OSError as error:
            raise self._failed(error) from None

    def _failed(self, error: OSError) -> SimulationError:
        return SimulationError(
            f"cannot write the log {error.filename or self._name}: {error.strerror}"
        )


def _seconds(time_ns: int) -> float:
    # The half is for the writer, which cuts what is below a nanosecond off.
    return (time_ns + 0.5) / 1e9
