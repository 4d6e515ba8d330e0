"""Bus logs in the formats of common tools."""

from __future__ import annotations

import contextlib
from pathlib import Path

import can

from seatrial.errors import SimulationError

from .frame import Frame
from .messages import error_message, message
from .operations import Error

_ERROR_FLAG = 0x20000000
"""Bit of the identifier of an error frame (linux/can.h)."""


class BusLog:
    """``NAME.blf`` (Vector's binary log) and ``NAME.log`` (as candump -L writes it).

    One entry for each frame and error frame, when it ended: simulated time, which is counted
    from 0; to the nanosecond in the first, to the microsecond in the second. The same entries
    leave the same bytes. Lines of the second are on disk at once, blocks of the first
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
        self._blf, self._text = can.BLFWriter(blf), text
        # Else times would be counted from the first frame: the format keeps dates after 1990 only.
        self._blf.start_timestamp = 0.0

    def frame(self, time_ns: int, frame: Frame) -> None:
        """Write a frame that ended then."""
        self._write(time_ns, message(frame, _seconds(time_ns)))

    def error(self, time_ns: int, error: Error) -> None:
        """Write an error frame that ended then."""
        self._write(time_ns, error_message(error, _seconds(time_ns)))

    def close(self) -> None:
        """Write what is left."""
        try:
            self._blf.stop()
            self._text.close()
        except OSError as error:
            raise self._failed(error) from None

    def _write(self, time_ns: int, entry: can.Message) -> None:
        microseconds = (time_ns + 500) // 1000
        when = f"{microseconds // 10**6}.{microseconds % 10**6:06}"
        try:
            self._text.write(f"({when}) {self._name} {_candump(entry)}\n")
            self._blf.on_message_received(entry)
        except OSError as error:
            raise self._failed(error) from None

    def _failed(self, error: OSError) -> SimulationError:
        return SimulationError(
            f"cannot write the log {error.filename or self._name}: {error.strerror}"
        )


def _candump(entry: can.Message) -> str:
    """Return a frame as candump -L writes it.

    python-can's writer adds the direction to each line, which canboat's readers refuse, and leaves
    out the length of remote frames and the class of errors.
    """
    if entry.is_error_frame:
        return f"{_ERROR_FLAG | entry.arbitration_id:08X}#{entry.data.hex().upper()}"
    identifier = f"{entry.arbitration_id:0{8 if entry.is_extended_id else 3}X}"
    if entry.is_remote_frame:
        return f"{identifier}#R{entry.dlc or ''}"
    flags = entry.bitrate_switch | entry.error_state_indicator << 1
    mark = f"#{flags:X}" if entry.is_fd else ""
    return f"{identifier}#{mark}{entry.data.hex().upper()}"


def _seconds(time_ns: int) -> float:
    # The half is for the writer, which cuts what is below a nanosecond off.
    return (time_ns + 0.5) / 1e9
