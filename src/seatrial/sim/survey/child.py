"""A call in a copy of this process, which may crash or hang there."""

from __future__ import annotations

import multiprocessing
import os
import tempfile
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import IO, Any

from ...errors import InputError, SimulationError
from ...fmi.isolation.exit_status import how_ended

_STREAMS = (1, 2)
_LONGEST = 300
"""Characters of what an FMU says on its end."""


def in_child(call: Callable[[], Any], timeout_s: float) -> Any:
    """Return what ``call`` returns in a child of this process; its streams go nowhere.

    Raises SimulationError for every exception there, if the child ends without an answer, and
    if it takes longer than ``timeout_s``; InputError where processes cannot be copied.
    """
    if os.name != "posix":
        raise InputError("a survey needs Linux or another POSIX system")
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    with tempfile.TemporaryFile() as said, receiver:
        child = context.Process(target=_answer, args=(call, sender, said), daemon=False)
        child.start()
        sender.close()
        try:
            if not receiver.poll(timeout_s):
                raise SimulationError(f"took longer than {timeout_s:g} s")
            kind, result = receiver.recv()
        except EOFError:
            child.join()
            last = f"; it said: {text}" if (text := _last_line(said)) else ""
            raise SimulationError(f"its process {how_ended(child.exitcode or 0)}{last}") from None
        finally:
            child.kill()
            child.join()
    if kind is not None:
        raise SimulationError(f"{kind}: {result}" if kind else result)
    return result


def _answer(call: Callable[[], Any], sender: Connection, said: IO[bytes]) -> None:
    for stream in _STREAMS:
        os.dup2(said.fileno(), stream)
    try:
        answer: tuple[str | None, Any] = None, call()
    except (InputError, SimulationError) as error:
        answer = "", str(error)
    except BaseException as error:  # whatever the other tool raises is its answer
        answer = type(error).__name__, str(error)
    sender.send(answer)
    os._exit(0)  # no FMU's library has a part in the end


def _last_line(said: IO[bytes]) -> str:
    said.seek(0)
    lines = [line.strip() for line in said.read().decode(errors="replace").splitlines()]
    return next((line[:_LONGEST] for line in reversed(lines) if line), "")
