"""Simulated board: a process that runs up to a given cycle, over two pipes.

A sketch that crashes, hangs or overruns its stack takes nothing else along. What a board sends is
a list of events, each with the CPU cycle at which it happened.
"""

from __future__ import annotations

import contextlib
import os
import re
import select
import struct
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from seatrial.errors import SimulationError

from .resources import laid_out
from .toolchain import arduino_core

_EVENT = struct.Struct("<BBHQ")
_INPUT = struct.Struct("<BBHd")
_PIECE = struct.Struct("<BBH8s")
_HEAD = struct.Struct("<IQI")
_ADDRESSES = re.compile(r" \[at((?: 0x[0-9a-f]+)*)\]")
UART, EDGE, DUTY, WIDTH, EEPROM, RESET, MESSAGE, MORE = (ord(letter) for letter in "TPDHeRMm")
"""Kinds of events: a byte has left a UART; a pin has another level, is modulated with a share, high
for so long; a byte of the EEPROM has changed; the board has started again; a message
to a device begins, and goes on."""

_ANSWER_S = 20.0
"""Wall clock: a program that takes this long for one step hangs where it cannot report it."""

_CALL = 0xFFFFFFFF
"""In the place of a size: a part is called."""

Event = tuple[int, int, int, int]
"""Kind, index, value, cycle."""


@dataclass
class Inputs:
    """Records sent to a board before it runs on: see ``shared/link.h``."""

    data: bytearray = field(default_factory=bytearray)

    def put(self, kind: str, index: int, number: float = 0.0, value: int = 0) -> None:
        """Add one record."""
        self.data += _INPUT.pack(ord(kind), index, value, number)

    def put_message(self, channel: int, message: bytes) -> None:
        """Add a message to a device: see ``machine/messages.h``."""
        self.put("M", channel, value=len(message))
        for at in range(0, len(message), 8):
            piece = message[at : at + 8]
            self.data += _PIECE.pack(ord("m"), channel, len(piece), piece)


Answer = Callable[[int, int, int, int, bytes], "tuple[int, Inputs]"]
"""What answers a call of a part: call, part, value, cycle, and bytes that were sent to it."""


class Board:
    """A running ``program``, ``name`` in messages; ``source`` has the lines of addresses."""

    def __init__(
        self,
        name: str,
        program: Path,
        *arguments: str,
        source: Path | None = None,
        answer: Answer | None = None,
    ) -> None:
        self.name, self._source = name, source or program
        self._answer = answer
        theirs_in, self._requests = os.pipe()
        self._answers, theirs_out = os.pipe()
        try:
            self._process = subprocess.Popen(
                [str(program), str(theirs_out), *arguments],
                stdin=theirs_in,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=(theirs_out,),
                start_new_session=True,
            )
        except BaseException:
            os.close(self._requests)
            os.close(self._answers)
            raise
        finally:
            os.close(theirs_in)
            os.close(theirs_out)
        self._buffer = bytearray()
        self._poll = select.poll()
        self._poll.register(self._answers, select.POLLIN)

    def run(self, target: int, inputs: Inputs) -> list[Event]:
        """Run until cycle ``target`` and return what happened.

        Raises SimulationError if the sketch has come to an end.
        """
        request = struct.pack("<IQ", 8 + len(inputs.data), target) + inputs.data
        try:
            # A program that could not begin has reported why and is gone before the request.
            with contextlib.suppress(BrokenPipeError):
                self._write(request)
            while (size := int.from_bytes(self._read(4), "little")) == _CALL:
                self._answer_call()
            answer = self._read(size)
        except (OSError, EOFError):
            raise SimulationError(f"{self.name}: its program {self._ended()}") from None
        reached, count = struct.unpack_from("<QI", answer)
        end = 12 + count * _EVENT.size
        if size > end:
            output = answer[end:].decode(errors="replace")
            seconds = reached / 16e6
            raise SimulationError(
                f"{self.name}: at {seconds:.6f} s of its time {self._placed(output)}"
            )
        return list(_EVENT.iter_unpack(answer[12:end]))

    def close(self) -> None:
        """End the program. Harmless when repeated."""
        if self._requests < 0:
            return
        os.close(self._requests)
        os.close(self._answers)
        self._requests = self._answers = -1
        self._process.kill()
        self._process.wait()

    # ------------------------------------------------------------------ inside

    def _answer_call(self) -> None:
        """Let a part answer what the board has called it for."""
        call, index, value, cycle = _EVENT.unpack(self._read(_EVENT.size))
        sent = self._read(int.from_bytes(self._read(4), "little"))
        result, inputs = (
            self._answer(call, index, value, cycle, sent) if self._answer else (0, Inputs())
        )
        self._write(struct.pack("<IQ", 8 + len(inputs.data), result) + inputs.data)

    def _write(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            view = view[os.write(self._requests, view) :]

    def _read(self, size: int) -> bytes:
        if len(self._buffer) < size:
            deadline = time.monotonic() + _ANSWER_S
            while len(self._buffer) < size:
                left = deadline - time.monotonic()
                if left <= 0:
                    self._process.kill()
                    raise SimulationError(
                        f"{self.name}: its program did not answer for {_ANSWER_S:g} s"
                    )
                if self._poll.poll(left * 1000.0):
                    data = os.read(self._answers, 1 << 16)
                    if not data:
                        raise EOFError
                    self._buffer += data
        taken = bytes(self._buffer[:size])
        del self._buffer[:size]
        return taken

    def _ended(self) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        code = self._process.returncode
        return f"ended by signal {-code}" if code is not None and code < 0 else f"ended ({code})"

    def _placed(self, output: str) -> str:
        """Return a message with a line in the place of addresses: the first that is a sketch's.

        Without one, it is the first of the board's own.
        """
        match = _ADDRESSES.search(output)
        if match is None:
            return output
        tool = "avr-addr2line" if self._source.suffix == ".elf" else "addr2line"
        command = [tool, "-e", str(self._source), *match[1].split()]
        with contextlib.suppress(OSError):
            found = subprocess.run(command, capture_output=True, text=True, check=False)
            lines = [each.split(" (")[0] for each in found.stdout.splitlines()]
            known = [each for each in lines if not each.startswith("?") and ":?" not in each]
            boards = (f"{arduino_core()}/", f"{laid_out()}/", "/build/", "/usr/")
            theirs = [each for each in known if not each.startswith(boards)]
            if place := [*theirs, *known][:1]:
                return output.replace(match[0], f" ({place[0]})")
        return output.replace(match[0], "")
