"""The supervisor's side of safe states: kept for other processes, and sent when they end."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import socket
import time
from dataclasses import dataclass
from typing import Any

_SEND_S = 1.0
"""Wall time that one safe state may take to be sent."""
_BUS_S = 5.0
"""The same of a bus, which is opened first: drivers wait for adapters."""
_IN_ORDER_S = 3.0
"""Wall time in which processes that the run started may end in order, and send it themselves."""
_LONGEST = 1 << 17


@dataclass
class _Entry:
    """One safe state, and the descriptor that it goes through; -1: a bus to be opened."""

    message: dict[str, Any]
    descriptor: int


class SafeStates:
    """Safe states of a process and of those that it starts.

    They have the other end of a socket, which is made before they are.
    """

    def __init__(self) -> None:
        self._ours, self._theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._ours.setblocking(False)
        self._entries: dict[tuple[int, int], _Entry] = {}
        self._processes: dict[int, int] = {}
        """Descriptors of the processes that hold something, by number."""

    def fileno(self) -> int:
        """Return the descriptor to wait at."""
        return self._ours.fileno()

    def left_to_child(self) -> int:
        """Keep, in a fork, the child's end alone; return its descriptor."""
        self._ours.close()
        return self._theirs.fileno()

    def take(self) -> None:
        """Take in what is held, changed and released."""
        while True:
            try:
                data, fds, _, _ = socket.recv_fds(self._ours, _LONGEST, 1)
            except BlockingIOError:
                return
            message = json.loads(data)
            key = (message["pid"], message["number"])
            if "released" in message:
                self._forget(key)
            elif "name" in message:
                self._entries[key] = _Entry(message, fds[0] if fds else -1)
                self._watch(message["pid"])
            elif key in self._entries:
                self._entries[key].message.update(message)

    def of_ended(self) -> list[str]:
        """Send what processes held that have ended; return a line for each safe state."""
        self.take()
        return [
            line
            for pid in list(self._processes)
            if _has_ended(pid, self._processes[pid])
            for line in self._send_of(pid)
        ]

    def all(self) -> list[str]:
        """Send everything that is still held, by processes that live too; return the lines.

        Those that still end in order may do it themselves first.
        """
        lines, deadline = self.of_ended(), time.monotonic() + _IN_ORDER_S
        while self._processes and time.monotonic() < deadline:
            time.sleep(0.01)
            lines += self.of_ended()
        return lines + [line for pid in list(self._processes) for line in self._send_of(pid)]

    def close(self) -> None:
        """Close everything."""
        for entry in self._entries.values():
            if entry.descriptor >= 0:
                os.close(entry.descriptor)
        for descriptor in self._processes.values():
            os.close(descriptor)
        self._ours.close()
        self._theirs.close()

    # ------------------------------------------------------------------ inside

    def _watch(self, pid: int) -> None:
        if pid not in self._processes:
            try:
                self._processes[pid] = os.pidfd_open(pid)
            except OSError:  # it has ended, and its parent knows
                self._processes[pid] = os.open(os.devnull, os.O_RDONLY)

    def _forget(self, key: tuple[int, int]) -> None:
        entry = self._entries.pop(key, None)
        if entry is not None and entry.descriptor >= 0:
            os.close(entry.descriptor)
        if not any(pid == key[0] for pid, _ in self._entries):
            descriptor = self._processes.pop(key[0], None)
            if descriptor is not None:
                os.close(descriptor)

    def _send_of(self, pid: int) -> list[str]:
        lines = []
        for key in [key for key in self._entries if key[0] == pid]:
            entry = self._entries[key]
            message = entry.message
            sent = _bus(message) if entry.descriptor < 0 else _data(message, entry.descriptor)
            said = "sent" if sent else "could not send"
            lines.append(f"{said} the safe state of {message['name']} to {message['where']}")
            self._forget(key)
        return lines


def _has_ended(pid: int, descriptor: int) -> bool:
    waiting = select.poll()
    waiting.register(descriptor, select.POLLIN)
    return bool(waiting.poll(0))


def _data(message: dict[str, Any], descriptor: int) -> bool:
    """Send bytes through a descriptor, for a bounded time; return whether it took them all."""
    data, address = bytes.fromhex(message["data"]), message["address"]
    deadline = time.monotonic() + _SEND_S
    with contextlib.suppress(OSError):
        os.set_blocking(descriptor, False)
        if address is not None:
            with socket.socket(fileno=os.dup(descriptor)) as opened:
                return opened.sendto(data, tuple(address)) == len(data)
        waiting = select.poll()
        waiting.register(descriptor, select.POLLOUT)
        while data and (left := deadline - time.monotonic()) > 0:
            if waiting.poll(left * 1e3):
                data = data[os.write(descriptor, data) :]
        return not data
    return False


def _bus(message: dict[str, Any]) -> bool:
    """Send frames to a bus, in a process of its own: drivers may take any time."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads: it touches none
        pid = os.fork()
    if not pid:
        status = 1
        try:
            from .can.safe_state import send_to_bus  # python-can, where there is a bus

            send_to_bus(message["bus"], message["frames"])
            status = 0
        finally:
            os._exit(status)
    deadline = time.monotonic() + _BUS_S
    while time.monotonic() < deadline:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return status == 0
        time.sleep(0.005)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    return False
