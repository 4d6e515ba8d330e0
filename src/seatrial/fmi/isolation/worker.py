"""The process of an isolated component: it answers the frames of `IsolatedInstance`.

Started as ``python -m seatrial.fmi.isolation.worker REQUESTS ANSWERS PARENT NAME``: two
descriptors, the process to end with, and the component's name for those who list processes.
"""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import io
import json
import logging
import math
import os
import signal
import struct
import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import InputError, SeatrialError, SimulationError
from ...links.safe_state import inherited
from ..files.options import FmuOptions
from ..instance import Instance, Reader
from ..loading.load import load_fmu, open_instance
from ..loading.sandbox import MEMORY
from .orphan import end_with
from .pipe import (
    CALL,
    ENDED,
    FAILURE,
    INTERVAL,
    MESSAGE,
    MOST_BYTES,
    READ,
    RESULT,
    WRITE,
    Codec,
    Frames,
    frame,
)

_PR_SET_PDEATHSIG = 1
_C_LINE_BUFFERED = 1
_ASKING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
_IN_ORDER_S = 2.0
"""Wall time to end in order once the parent was killed."""


class Worker:
    """Holds the instance, and what the parent has bound of it.

    An error of a write waits for the next request and is its answer.
    """

    def __init__(self, requests: int, answers: int) -> None:
        self._requests, self._answers, self._own = requests, answers, os.getpid()
        self._instance: Instance
        self._is_open = False
        self._writers: dict[int, Callable[[bytes], None]] = {}
        self._readers: dict[int, tuple[Reader, Codec]] = {}
        self._states: dict[int, Any] = {}
        self._last_number = 0
        self._failed_write: BaseException | None = None
        self._failed_reads: dict[int, BaseException] = {}
        """Readers that failed when they were called ahead, right after a step."""

    def serve(self) -> None:
        """Answer requests until the parent closes its end; if it was killed, end in order."""
        frames = Frames()
        try:
            while data := os.read(self._requests, MOST_BYTES):
                frames.feed(data)
                while (request := frames.take()) is not None:
                    self._serve(*request)
        except (OrphanedError, BrokenPipeError):
            pass
        if self._is_open:
            self.call_terminate()  # links send what stops things, and close

    def _serve(self, code: int, number: int, payload: bytes) -> None:
        try:
            if code == WRITE:
                self._failed_reads.clear()
                if self._failed_write is None:
                    self._writers[number](payload)
                return
            if self._failed_write is not None:
                failure, self._failed_write = self._failed_write, None
                raise failure
            answer = frame(RESULT, number, self._answer(code, number, payload))
        except OrphanedError:
            raise
        except BaseException as error:  # SystemExit, KeyboardInterrupt: the parent handles them
            if code == WRITE:
                self._failed_write = error
                return
            answer = frame(FAILURE, number, _explained(error))
        self._send(answer)

    def _answer(self, code: int, number: int, payload: bytes) -> bytes:
        if code == READ:
            return self._read(number)
        self._failed_reads.clear()
        if code == CALL:
            method, *arguments = json.loads(payload)
            return json.dumps(getattr(self, f"call_{method}")(*arguments)).encode()
        return self._step(payload)

    def _step(self, payload: bytes) -> bytes:
        """Step, and read ahead what the parent has read after earlier steps."""
        self._instance.step(*INTERVAL.unpack_from(payload))
        ended_at = self._instance.ended_at
        ahead = [ENDED.pack(math.nan if ended_at is None else ended_at)]
        for (number,) in struct.iter_unpack("<I", payload[INTERVAL.size :]):
            try:
                ahead.append(frame(RESULT, number, self._read(number)))
            except BaseException as error:  # for the read, if it comes
                self._failed_reads[number] = error
        return b"".join(ahead)

    def _read(self, number: int) -> bytes:
        if number in self._failed_reads:
            raise self._failed_reads.pop(number)
        reader, codec = self._readers[number]
        return codec.pack(reader())

    def _send(self, data: bytes) -> None:
        if os.getpid() != self._own:
            os._exit(0)  # a copy of this process that a component made by fork, and that returned
        while data:
            data = data[os.write(self._answers, data) :]

    # ------------------------------------------------------------------ calls in JSON

    def call_open(
        self,
        path: str,
        sha256: str,
        name: str,
        module_path: list[str],
        options: dict[str, Any],
        built: str | None,
    ) -> list[bool]:
        """Load the FMU; return whether it rolls back, and takes steps of any length."""
        sys.path[:] = module_path
        logger = logging.getLogger(f"seatrial.fmu.{name}")
        logger.addHandler(_Forwarder(self._send))
        logger.setLevel(1)
        logger.propagate = False
        fmu = load_fmu(Path(path), FmuOptions(**options))
        if fmu.sha256 != sha256:
            raise InputError(f"{path} was changed while it was being loaded")
        if built is not None:
            fmu = replace(fmu, built=Path(built))
        self._instance = open_instance(fmu, name)
        self._is_open = True
        instance = self._instance
        return [instance.rolls_back, instance.any_step, instance.restarts]

    def call_reader(self, names: list[str]) -> int:
        """Bind a reader; return its number."""
        number = self._next_number()
        self._readers[number] = self._instance.reader(names), self._codec(names)
        return number

    def call_writer(self, names: list[str]) -> int:
        """Bind a writer; return its number."""
        put, codec = self._instance.writer(names), self._codec(names)

        def write(payload: bytes) -> None:
            try:
                put(codec.unpack(payload))
            except SimulationError as error:
                raise type(error)(f"{error}\n(in the write of {shortened(names)})") from None

        return self._bind(write)

    def call_starter(self, names: list[str]) -> int:
        """Bind what sets start values; return its number."""
        set_start, codec = self._instance.set_start, self._codec(names)
        return self._bind(
            lambda payload: set_start(dict(zip(names, codec.unpack(payload), strict=True)))
        )

    def call_wait(self) -> None:
        """Do nothing: the answer says that everything before is done."""

    def call_initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._instance.initialise(start_time, stop_time)

    def call_begin(self) -> float | None:
        """End the initialisation; return when the component asked to end the simulation."""
        self._instance.begin()
        return self._instance.ended_at

    def call_goes_back(self, may: bool) -> None:
        """Say whether a state of before the next step may be restored."""
        self._instance.goes_back(may)

    def call_get_state(self) -> int:
        """Keep the whole state; return its number."""
        number = self._next_number()
        self._states[number] = self._instance.get_state()
        return number

    def call_set_state(self, number: int) -> None:
        """Restore a state."""
        self._instance.set_state(self._states[number])

    def call_free_state(self, number: int) -> None:
        """Release a state."""
        self._instance.free_state(self._states.pop(number))

    def call_reset(self) -> None:
        """Return to before the start values."""
        self._instance.reset()

    def call_terminate(self) -> None:
        """End the run."""
        self._instance.terminate()

    def call_free(self) -> None:
        """Release the instance."""
        self._is_open = False
        self._instance.free()

    # ------------------------------------------------------------------ inside

    def _next_number(self) -> int:
        self._last_number += 1
        return self._last_number

    def _codec(self, names: list[str]) -> Codec:
        return Codec([self._instance.variables[name].type for name in names])

    def _bind(self, write: Callable[[bytes], None]) -> int:
        number = self._next_number()
        self._writers[number] = write
        return number


class _Forwarder(logging.Handler):
    """Sends log messages to the parent, as frames of their own."""

    def __init__(self, send: Callable[[bytes], None]) -> None:
        super().__init__()
        self._send = send

    def emit(self, record: logging.LogRecord) -> None:
        text = record.getMessage().encode("utf-8", "surrogatepass")
        self._send(frame(MESSAGE, record.levelno, text))


def shortened(names: list[str]) -> str:
    """Return names for a message, the first few of many."""
    more = f" and {len(names) - 4} more" if len(names) > 4 else ""
    return ", ".join(names[:4]) + more


def _explained(error: BaseException) -> bytes:
    """Return an error's kind and text; with the traceback unless it is written for users."""
    text = str(error)
    if not isinstance(error, SeatrialError):
        text = "".join(traceback.format_exception(error)).strip()
    return json.dumps([type(error).__name__, text]).encode()


class OrphanedError(BaseException):
    """The parent was killed: nobody waits for an answer."""


def _live_as_long_as(parent: int) -> None:
    """End with the parent, even in a call that never returns; not with its terminal."""

    def heed(_number: int, _frame: object) -> None:
        if os.getppid() != parent:
            for number in _ASKING:
                signal.signal(number, signal.SIG_IGN)
            raise OrphanedError

    for number in _ASKING:
        # Not SIG_IGN: a program that a component starts would ignore them too.
        signal.signal(number, heed)
        signal.siginterrupt(number, False)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it ended before the line above
        os._exit(1)
    end_with(parent, _IN_ORDER_S)


def _write_lines_at_once() -> None:
    """Let nothing that was printed wait in a buffer when the process dies."""
    faulthandler.enable()
    faulthandler.register(signal.SIGUSR1)  # sent before a process that hangs is ended
    for stream in (sys.stdout, sys.stderr):
        assert isinstance(stream, io.TextIOWrapper)
        stream.reconfigure(line_buffering=True, errors="backslashreplace")
    if sys.platform == "linux":
        libc = ctypes.CDLL(None)
        libc.setvbuf(ctypes.c_void_p.in_dll(libc, "stdout"), None, _C_LINE_BUFFERED, 0)


def _limit_memory() -> None:
    """Let allocations fail from the limit on that the environment has, for good."""
    if limit := os.environ.get(MEMORY):
        import resource  # not on Windows, where there is no sandbox

        # Not RLIMIT_AS: libraries reserve address space by the processor, and use little of it.
        resource.setrlimit(resource.RLIMIT_DATA, (int(limit), int(limit)))


def main() -> None:
    """Serve the parent until it closes its end."""
    requests, answers, parent = (int(text) for text in sys.argv[1:4])
    _live_as_long_as(parent)
    _limit_memory()
    _write_lines_at_once()
    for descriptor in (requests, answers, *inherited()):
        os.set_inheritable(descriptor, False)  # not for processes that a component starts
    with contextlib.suppress(BrokenPipeError):  # the parent has gone
        Worker(requests, answers).serve()


if __name__ == "__main__":
    main()
