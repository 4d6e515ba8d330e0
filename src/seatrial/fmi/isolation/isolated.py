"""An FMU in a process of its own, as the master sees it: a crash or a hang ends that process only.

Inputs written are sent along with the next step or read, which also raises their errors. With
the answer of a step come the outputs that were read after earlier ones: one round trip then
does for everything.
"""

from __future__ import annotations

import json
import logging
import math
import os
import struct
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ...errors import DiscardError, InputError, SimulationError
from ..instance import Reader, Value, Writer
from ..interfaces.loaded import LoadedFmu
from ..interfaces.origins import with_origins
from ..loading.built import with_library
from ..loading.sandbox import MEMORY_GIB, PARENT, sandbox_command, sandbox_environment
from .pipe import CALL, ENDED, INTERVAL, READ, RESULT, STEP, WRITE, Codec, Frames, frame
from .process import EndedError, WorkerProcess
from .worker import shortened

_BOOT_S = 60.0
"""For Python to start and import: no call of the FMU has a part in it."""
_NO_ANSWER = (ValueError, TypeError, OverflowError, RecursionError, struct.error)
_ERRORS = {kind.__name__: kind for kind in (DiscardError, InputError, SimulationError)}


class IsolatedInstance:
    """An instance of a loaded FMU in a process of its own; fulfils `Instance`.

    A call that takes longer than ``timeout_s`` ends the process. Once it has ended, every call
    but `terminate` and `free` raises the same SimulationError. Make and use it in one thread.

    ``sandboxed`` lets it see no network and no files but its own; see `sandbox`.

    Raises InputError where there are no POSIX pipes, or no sandbox, and what `open_instance`
    raises.
    """

    def __init__(
        self, fmu: LoadedFmu, name: str, timeout_s: float, *, sandboxed: bool = False
    ) -> None:
        if os.name != "posix":
            raise InputError("isolated components need Linux or another POSIX system")
        fmu = with_library(fmu, sandboxed=sandboxed)
        self.name, self.fmu = name, fmu
        self.variables, self.feedthrough = fmu.variables, fmu.feedthrough
        self.terminals, self.views = fmu.terminals, fmu.views
        self._timeout_s, self._limit = _BOOT_S, ""
        self._time: float | None = None
        self.ended_at: float | None = None
        self._ended = ""
        self._writes: list[bytes] = []
        self._written: list[str] = []
        """Frames of writes that are not sent yet, and the inputs in them."""
        self._read_after_steps: list[int] = []
        self._ahead: dict[int, bytes] = {}
        """Answers that came with that of the last step, by reader."""
        self._just_stepped = False
        # The worker finds the FMU unpacked where it is now.
        environment = {**os.environ, "SEATRIAL_CACHE": str(fmu.folder.parent.parent)}
        sandbox, parent = list[str](), None
        self._memory = f" (its sandbox has {MEMORY_GIB} GiB of memory)" if sandboxed else ""
        if sandboxed:
            sandbox, parent = sandbox_command(fmu), PARENT
            environment = sandbox_environment(fmu)
        self._logger = logging.getLogger(f"seatrial.fmu.{name}")
        self._process = WorkerProcess(
            "seatrial.fmi.isolation.worker", name, environment, self._log, sandbox, parent
        )
        try:
            self._call("wait", "its start")
            self._timeout_s, self._limit = timeout_s, " (the component's key 'timeout')"
            able = self._call(
                "open",
                "its instantiation",
                str(fmu.path),
                fmu.sha256,
                name,
                sys.path,
                fmu.options.as_json(),
                None if fmu.built is None else str(fmu.built),
            )
            if not (isinstance(able, list) and len(able) == 3):
                raise self._misunderstood("its instantiation")
            self.rolls_back, self.any_step, self.restarts = map(bool, able)
            self.at_once = fmu.at_once
        except BaseException:
            self._process.end()
            raise

    @property
    def pid(self) -> int:
        """Of its process."""
        return self._process.pid

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set parameters and start values by variable name, before `initialise`."""
        if values:
            names = list(values)
            self._writer("starter", names)(list(values.values()))
            self._call("wait", f"the setting of {shortened(names)}")

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._time = start_time
        self._call("initialise", "its initialisation", start_time, stop_time)

    def begin(self) -> None:
        """End the initialisation."""
        ended_at = self._call("begin", "the end of its initialisation")
        self.ended_at = None if ended_at is None else self._time_of(ended_at)

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a callable that returns the values of ``names``, in that order."""
        number, codec = self._bound("reader", names)
        request = frame(READ, number)
        what = f"the reading of {shortened(list(names))}"

        def read() -> list[Any]:
            answer = self._ahead.pop(number, None)
            if answer is None:
                if self._just_stepped:
                    self._read_after_steps.append(number)
                answer = self._ask(request, lambda: what + self._when())
            try:
                return codec.unpack(answer)
            except _NO_ANSWER:
                raise self._misunderstood(what + self._when()) from None

        return read

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a callable that sets ``names`` to a sequence of values.

        An error is raised by the next step, reading or other call.
        """
        return self._writer("writer", list(names))

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s."""
        wanted = self._read_after_steps
        payload = INTERVAL.pack(t, h) + struct.pack(f"<{len(wanted)}I", *wanted)
        self._touched()
        answer = self._ask(frame(STEP, 0, payload), lambda: f"step(t = {t!r} s, h = {h!r} s)")
        try:
            (ended_at,) = ENDED.unpack_from(answer)
            self._ahead = _by_number(answer[ENDED.size :])
        except _NO_ANSWER:
            raise self._misunderstood("a step") from None
        self.ended_at = None if math.isnan(ended_at) else ended_at
        self._time, self._just_stepped = t + h, True

    def goes_back(self, may: bool) -> None:
        """Say whether a state of before the next step may be restored after it."""
        self._call("goes_back", "the notice of restored states", may)

    def get_state(self) -> Any:
        """Return the number of the whole state, which is kept in the process."""
        return self._call("get_state", "the saving of its state")

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""
        self._touched()
        self.ended_at = None
        self._call("set_state", "the restoring of a state", state)

    def free_state(self, state: Any) -> None:
        """Release a state."""
        self._call("free_state", "the release of a state", state)

    def reset(self) -> None:
        """Return to before `set_start`."""
        self._touched()
        self.ended_at = None
        self._call("reset", "its reset")

    def terminate(self) -> None:
        """End the run."""
        if not self._ended:
            self._call("terminate", "its termination")

    def free(self) -> None:
        """Release the instance and end its process. Raises SimulationError if it dies in that."""
        if not self._ended:
            try:
                self._call("free", "its release")
            finally:
                self._process.wait()
                self._ended = f"{self.name} has been released"

    # ------------------------------------------------------------------ inside

    def _writer(self, kind: str, names: list[str]) -> Writer:
        number, codec = self._bound(kind, names)
        said = shortened(names)

        def write(values: Sequence[Any]) -> None:
            self._refuse_ended()
            self._touched()
            self._writes.append(frame(WRITE, number, codec.pack(values)))
            self._written.append(said)

        return write

    def _bound(self, kind: str, names: Sequence[str]) -> tuple[int, Codec]:
        number = self._call(kind, "the binding of its variables", list(names))
        return number, Codec([self.variables[name].type for name in names])

    def _time_of(self, answer: Any) -> float:
        try:
            return float(answer)
        except _NO_ANSWER:
            raise self._misunderstood("the end of its initialisation") from None

    def _touched(self) -> None:
        """Forget what was read ahead: it is no longer what a reader would read."""
        self._ahead = {}
        self._just_stepped = False

    def _when(self) -> str:
        return "" if self._time is None else f" at t = {self._time!r} s"

    def _call(self, method: str, what: str, *arguments: Any) -> Any:
        request = frame(CALL, 0, json.dumps([method, *arguments]).encode())
        answer = self._ask(request, lambda: what + self._when())
        try:
            return json.loads(answer)
        except _NO_ANSWER:
            raise self._misunderstood(what) from None

    def _ask(self, request: bytes, what: Callable[[], str]) -> bytes:
        """Return the answer to a request, with the writes before it."""
        self._refuse_ended()
        writes, written = self._writes, self._written
        if writes:
            self._writes, self._written = [], []
            request = b"".join((*writes, request))
        try:
            code, _, answer = self._process.exchange(request, self._timeout_s)
        except EndedError as end:
            before = f" or the write of {'; '.join(written)} before it" if written else ""
            how = end.how + (self._limit if end.timed_out else self._memory)
            raise self._end(how, what() + before, end.printed) from None
        except ValueError:  # something wrote into the pipe that does not belong there
            raise self._end("was ended for an answer that is none", what()) from None
        except BaseException:
            self._end("was ended by an interruption", what())
            raise
        if code == RESULT:
            return answer
        try:
            kind, text = map(str, json.loads(answer))
        except _NO_ANSWER:
            raise self._misunderstood(what()) from None
        text = with_origins(text, self.fmu)
        if kind == KeyboardInterrupt.__name__:
            raise KeyboardInterrupt
        if MemoryError.__name__ in text:
            text += self._memory
        if kind not in _ERRORS:
            raise SimulationError(f"{self.name}: {what()} raised\n{text}")
        raise _ERRORS[kind](text)

    def _end(self, how: str, what: str, printed: str = "") -> SimulationError:
        """Keep what every further call will raise, and return it."""
        last = f"; the last it wrote:\n{with_origins(printed, self.fmu)}" if printed else ""
        self._ended = f"{self.name}: its process {how} in {what}{last}"
        return SimulationError(self._ended)

    def _misunderstood(self, what: str) -> SimulationError:
        """End a process that answers what no worker does: the FMU has taken it over."""
        self._process.end()
        return self._end("was ended for an answer that is none", what)

    def _refuse_ended(self) -> None:
        if self._ended:
            raise SimulationError(self._ended)

    def _log(self, level: int, text: str) -> None:
        self._logger.log(level, "%s", text)


def _by_number(answer: bytes) -> dict[int, bytes]:
    """Return the payloads of frames, by their numbers."""
    frames, found = Frames(), {}
    frames.feed(answer)
    while (part := frames.take()) is not None:
        found[part[1]] = part[2]
    return found
