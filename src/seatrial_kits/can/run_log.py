"""Bus log of a run: logs and statistics in the run's folder."""

from __future__ import annotations

import contextlib
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import can

from seatrial.errors import SimulationError

from .controller import Controller
from .frame import Frame
from .messages import error_message, message
from .operations import Error
from .simulated_bus import PS, Broken, Sent, SimulatedBus

_PS_PER_NS = 1000


class RunLog:
    """The logs of `BusLog`, and at the end ``NAME.json`` (`Statistics`); nothing without a folder.

    Each attempt to send is entered once: a step that is repeated after a rollback brings the
    same frames again.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._folder: Path | None = None
        self._log: BusLog | None = None
        self._statistics = Statistics()
        self._entered = 0

    def open(self, folder: str) -> None:
        """Begin the files in ``folder``, once; an empty text is none."""
        if folder and self._log is None:
            self._folder = Path(folder)
            self._log = BusLog(self._folder, self._name)

    def sent(self, attempt: int, sent: Sent, latency_ps: int) -> None:
        """Enter a frame."""
        if self._log is not None and attempt > self._entered:
            self._entered = attempt
            self._log.frame(-(-sent.end_ps // _PS_PER_NS), sent.frame)
            self._statistics.sent(sent.frame, latency_ps)

    def broken(self, attempt: int, broken: Broken) -> None:
        """Enter an error frame."""
        if self._log is not None and attempt > self._entered:
            self._entered = attempt
            self._log.error(-(-broken.end_ps // _PS_PER_NS), broken.error)
            self._statistics.broken(broken.error.name.lower())

    def close(self, bus: SimulatedBus, begun_ps: int) -> None:
        """Write what is left, and the statistics; a new one may be opened."""
        if self._log is None or self._folder is None:
            return
        log, self._log = self._log, None
        log.close()
        duration = (bus.now_ps - begun_ps) / PS
        found = self._statistics.summary(duration, bus.busy_ps / PS, bus.controllers)
        path = self._folder / f"{self._name}.json"
        try:
            with path.open("x", encoding="utf-8", newline="\n") as file:
                file.write(json.dumps(found, indent=1) + "\n")
        except OSError as error:
            raise SimulationError(f"cannot write {path}: {error.strerror}") from None


_PERCENTILES = (50, 95, 99)
_PS_PER_US = 10**6


class Statistics:
    """Counts and latencies; a latency is from the request to the end of the frame.

    Latencies are kept to the microsecond, rounded up: so memory does not grow with time.
    """

    def __init__(self) -> None:
        self._latencies: dict[tuple[int, bool], Counter[int]] = {}
        self._error_frames: Counter[str] = Counter()

    def sent(self, frame: Frame, latency_ps: int) -> None:
        """Count a frame."""
        key = (frame.identifier, frame.extended)
        found = self._latencies.get(key)
        if found is None:
            found = self._latencies[key] = Counter()
        found[-(-latency_ps // _PS_PER_US)] += 1

    def broken(self, error: str) -> None:
        """Count an error frame."""
        self._error_frames[error] += 1

    def summary(
        self, duration_s: float, busy_s: float, controllers: Sequence[Controller]
    ) -> dict[str, Any]:
        """Return all of it as plain data, times in s."""
        return {
            "duration_s": duration_s,
            "load": round(busy_s / duration_s, 9) if duration_s else 0.0,
            "frames": sum(counts.total() for counts in self._latencies.values()),
            "error_frames": dict(sorted(self._error_frames.items())),
            "identifiers": [
                {
                    "identifier": f"0x{identifier:0{8 if extended else 3}X}",
                    "frames": counts.total(),
                    "rate_hz": round(counts.total() / duration_s, 6) if duration_s else 0.0,
                    "latency_s": _latency(counts),
                }
                for (identifier, extended), counts in sorted(self._latencies.items())
            ],
            "nodes": [
                {
                    "name": each.name,
                    "state": each.state.name.lower(),
                    **{name: getattr(each, name) for name in _COUNTS},
                }
                for each in controllers
            ],
        }


_COUNTS = ("asked", "sent", "received", "lost", "dropped", "waiting", "tec", "rec")


def _latency(counts: Counter[int]) -> dict[str, float]:
    values, total = sorted(counts), counts.total()
    found = {
        "min": values[0] / 1e6,
        "mean": round(sum(value * count for value, count in counts.items()) / total / 1e6, 9),
        "max": values[-1] / 1e6,
    }
    for percent in _PERCENTILES:
        rank, seen = -(-percent * total // 100), 0  # the nearest rank
        for value in values:
            seen += counts[value]
            if seen >= rank:
                found[f"p{percent}"] = value / 1e6
                break
    return found


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
