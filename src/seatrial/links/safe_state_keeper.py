"""The keeper's side of safe states: kept for other processes, and sent when they have ended."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import socket
import sys
import time
from dataclasses import dataclass
from typing import Any

with contextlib.suppress(ImportError):  # not on Windows; a copy of a process imports nothing
    import fcntl
    import termios

_SEND_S = 1.0
"""Wall time that one safe state may take to be sent."""
_BUS_S = 5.0
"""The same of a bus, which is opened first: drivers wait for adapters."""
_KILLED_S = 2.0
"""The same for the end of a process that was killed; one stuck in the kernel takes longer."""
_QUEUE_S = 0.5
"""Wall time in which a line may take what is queued for it; what is left then is dropped."""
_LONGEST = 1 << 17


@dataclass
class _Entry:
    """One safe state, and the descriptor that it goes through; -1: a bus to be opened."""

    message: dict[str, Any]
    descriptor: int


class Process:
    """A process that is no child of this one."""

    def __init__(self, pid: int) -> None:
        self._pid, self._descriptor = pid, -1
        with contextlib.suppress(OSError, AttributeError):  # it has ended; there are none
            self._descriptor = os.pidfd_open(pid)

    def fileno(self) -> int:
        """Return what can be waited at until it has ended; -1 if there is nothing."""
        return self._descriptor

    def has_ended(self) -> bool:
        """Return whether it has ended, and with it all that it had open."""
        if self._descriptor >= 0:
            return _is_ready(self._descriptor, select.POLLIN, 0.0)
        try:
            os.kill(self._pid, 0)
        except OSError:
            return True
        return False

    def kill(self) -> None:
        """Kill it."""
        with contextlib.suppress(OSError):
            if self._descriptor >= 0:
                signal.pidfd_send_signal(self._descriptor, signal.SIGKILL)
            elif not self.has_ended():
                os.kill(self._pid, signal.SIGKILL)

    def close(self) -> None:
        """Forget it."""
        if self._descriptor >= 0:
            os.close(self._descriptor)


class SafeStates:
    """Safe states of a process and of those that it starts.

    They have the other end of a socket, which is made before they are.
    """

    def __init__(self) -> None:
        self._ours, self._theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._ours.setblocking(False)
        self._entries: dict[tuple[int, int], _Entry] = {}
        self._processes: dict[int, Process] = {}
        """Those that hold something, by number."""
        self.waits = 0
        """How often one has said that it waits for somebody, and does not hang."""

    def fileno(self) -> int:
        """Return the descriptor to wait at."""
        return self._ours.fileno()

    def left_to_child(self) -> int:
        """Keep, in a fork, the child's end alone; return its descriptor."""
        self._ours.close()
        return self._theirs.fileno()

    def left_to_keeper(self) -> int:
        """Keep, in a fork, the keeper's end alone; return its descriptor."""
        self._theirs.close()
        return self._ours.fileno()

    def take(self) -> None:
        """Take in what is held, changed and released."""
        while True:
            try:
                data, fds, _, _ = socket.recv_fds(self._ours, _LONGEST, 1)
            except BlockingIOError:
                return
            message = json.loads(data)
            if "waits" in message:
                self.waits += 1
                continue
            key = (message["pid"], message["number"])
            if "released" in message:
                self._forget(key)
            elif "name" in message:
                self._entries[key] = _Entry(message, fds[0] if fds else -1)
                self._watch(message["pid"])
            elif key in self._entries:
                self._entries[key].message.update(message)

    @property
    def held(self) -> bool:
        """Whether anything is held."""
        return bool(self._entries)

    def descriptors(self) -> list[int]:
        """Return what can be waited at until something is to be taken in, or one has ended."""
        ended = [process.fileno() for process in self._processes.values()]
        return [self._ours.fileno(), *(each for each in ended if each >= 0)]

    def of_ended(self) -> list[str]:
        """Send what processes held that have ended; return a line for each safe state."""
        self.take()
        ended = {pid for pid, process in self._processes.items() if process.has_ended()}
        return self._send([key for key in self._entries if key[0] in ended])

    def of_killed(self, *others: Process) -> list[str]:
        """End the processes that hold something, and ``others``; send all; return the lines.

        Nothing of theirs comes after what is sent: they have ended before.
        """
        self.take()
        killed = [*self._processes.values(), *others]
        for process in killed:
            process.kill()
        deadline = time.monotonic() + _KILLED_S
        while time.monotonic() < deadline and not all(each.has_ended() for each in killed):
            time.sleep(0.001)
        self.take()
        return self._send(list(self._entries))

    def close(self) -> None:
        """Close everything."""
        for entry in self._entries.values():
            if entry.descriptor >= 0:
                os.close(entry.descriptor)
        for process in self._processes.values():
            process.close()
        self._ours.close()
        self._theirs.close()

    # ------------------------------------------------------------------ inside

    def _watch(self, pid: int) -> None:
        if pid not in self._processes:
            self._processes[pid] = Process(pid)

    def _forget(self, key: tuple[int, int]) -> None:
        entry = self._entries.pop(key, None)
        if entry is not None and entry.descriptor >= 0:
            os.close(entry.descriptor)
        if not any(pid == key[0] for pid, _ in self._entries):
            process = self._processes.pop(key[0], None)
            if process is not None:
                process.close()

    def _send(self, keys: list[tuple[int, int]]) -> list[str]:
        """Send what ``keys`` hold, lines first: a bus takes its time, beside the others."""
        entries = [self._entries[key] for key in keys]
        lines = {}
        for entry in entries:
            if entry.descriptor >= 0:
                lines[id(entry)] = _data(entry.message, entry.descriptor)
        buses = {id(each): _bus(each.message) for each in entries if each.descriptor < 0}
        deadline = time.monotonic() + _BUS_S
        lines |= {number: _has_sent(pid, deadline) for number, pid in buses.items()}
        for key in keys:
            self._forget(key)
        return [
            f"{'sent' if lines[id(each)] else 'could not send'} the safe state of "
            f"{each.message['name']} to {each.message['where']}"
            for each in entries
        ]


def _is_ready(descriptor: int, event: int, timeout_s: float) -> bool:
    waiting = select.poll()
    waiting.register(descriptor, event)
    return bool(waiting.poll(timeout_s * 1e3))


def _data(message: dict[str, Any], descriptor: int) -> bool:
    """Send bytes through a descriptor, for a bounded time; return whether it took them all."""
    data, address = bytes.fromhex(message["data"]), message["address"]
    with contextlib.suppress(OSError):
        os.set_blocking(descriptor, False)
        if address is not None:
            with socket.socket(fileno=os.dup(descriptor)) as opened:
                return opened.sendto(data, tuple(address)) == len(data)
        if os.isatty(descriptor):
            _empty(descriptor)
        deadline = time.monotonic() + _SEND_S
        while data and (left := deadline - time.monotonic()) > 0:
            if _is_ready(descriptor, select.POLLOUT, left):
                data = data[os.write(descriptor, data) :]
        if os.isatty(descriptor):
            from .endpoints.pseudo_terminal import wait_until_others_read

            wait_until_others_read(descriptor)
        return not data
    return False


def _empty(line: int) -> None:
    """Let a line take what is queued for it, and drop the rest: orders that nobody is to get."""
    deadline = time.monotonic() + _QUEUE_S
    while time.monotonic() < deadline:
        queued = fcntl.ioctl(line, termios.TIOCOUTQ, b"\0\0\0\0")
        if not int.from_bytes(queued, sys.byteorder) and _is_ready(line, select.POLLOUT, 0.0):
            return
        time.sleep(0.005)
    termios.tcflush(line, termios.TCOFLUSH)


def _bus(message: dict[str, Any]) -> int:
    """Begin to send frames to a bus; return the process that does: drivers may take any time."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads: it touches none
        pid = os.fork()
    if not pid:
        status = 1
        try:
            from ..plugins import service  # python-can, where there is a bus

            service("can.send_to_bus")(message["bus"], message["frames"])
            status = 0
        finally:
            os._exit(status)
    return pid


def _has_sent(pid: int, deadline: float) -> bool:
    """Return whether a process of `_bus` has sent its frames in time; it is over then."""
    while time.monotonic() < deadline:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return status == 0
        time.sleep(0.005)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    return False
