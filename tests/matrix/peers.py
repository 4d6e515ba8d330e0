"""Other ends of links: each is polled, keeps what it was sent, and can send, go and be in the way."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import struct
import tty
from pathlib import Path

from seatrial.links.own_terminals import claim

HOST = "127.0.0.1"
_KEPT = 1 << 16


class Peer:
    """One other end. ``url`` is the link's, ``left`` says what of it is still there afterwards."""

    url = ""

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        self.received, self._hello, self._greeted = b"", hello, False

    def poll(self) -> None:
        """Connect, greet, and read what has come."""

    def send(self, data: bytes) -> None:
        """Send, as far as it is connected."""

    def found(self, where: str) -> None:
        """Take note of what the run says to connect to."""

    def take(self) -> None:
        """Be in the way: another program has what the link needs."""

    def unplug(self) -> None:
        """Go without a word."""

    def left(self, *, orderly: bool) -> str:
        """Return what the run has left behind of the link, ``orderly`` ended or not; empty for nothing."""
        return ""

    def close(self) -> None:
        """Let go of everything."""

    def _keep(self, data: bytes) -> None:
        self.received = (self.received + data)[-_KEPT:]


def free_port(kind: socket.SocketKind) -> int:
    with socket.socket(type=kind) as one:
        one.bind((HOST, 0))
        return int(one.getsockname()[1])


class _AtSocket(Peer):
    """A peer at a socket, which is made when it can be."""

    kind = socket.SOCK_STREAM
    listened = False
    """Whether the run listens at ``port``."""

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        super().__init__(folder, name, hello)
        self.port = free_port(self.kind)
        self.socket: socket.socket | None = None
        self._blocker: socket.socket | None = None

    def send(self, data: bytes) -> None:
        if self.socket is not None:
            with contextlib.suppress(OSError):
                self.socket.send(data)

    def take(self) -> None:
        self._blocker = socket.socket(type=self.kind)
        self._blocker.bind((HOST, self.port))
        if self.kind == socket.SOCK_STREAM:
            self._blocker.listen()

    def unplug(self) -> None:
        if self.socket is not None:
            self.socket.close()
            self.socket = None

    def left(self, *, orderly: bool) -> str:
        if not self.listened or self._blocker is not None:
            return ""
        with socket.socket(type=self.kind) as one:
            one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, self.kind == socket.SOCK_STREAM)
            try:
                one.bind((HOST, self.port))
            except OSError as error:
                return f"port {self.port}: {error.strerror}"
        return ""

    def close(self) -> None:
        self.unplug()
        if self._blocker is not None:
            self._blocker.close()

    def _read(self) -> None:
        assert self.socket is not None
        try:
            while data := self.socket.recv(65536):
                self._keep(data)
        except OSError:
            pass  # nothing there, or gone


class Caller(_AtSocket):
    """A client of a TCP server."""

    listened = True

    def poll(self) -> None:
        if self.socket is None and self._blocker is None:
            one = socket.socket()
            one.settimeout(0.2)
            try:
                one.connect((HOST, self.port))
            except OSError:
                one.close()
                return
            if one.getsockname() == one.getpeername():  # a port that nobody has met itself
                one.close()
                return
            one.setblocking(False)
            self.socket = one
            self.send(self._hello)
        if self.socket is not None:
            self._read()


class Server(_AtSocket):
    """A TCP server."""

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        super().__init__(folder, name, hello)
        self._server = socket.create_server((HOST, self.port))
        self._server.setblocking(False)

    def poll(self) -> None:
        if self.socket is None:
            with contextlib.suppress(OSError):  # nobody, or it is closed
                self.socket, _ = self._server.accept()
                self.socket.setblocking(False)
        if self.socket is not None:
            self._read()

    def unplug(self) -> None:
        super().unplug()
        self._server.close()


class Sender(_AtSocket):
    """A program that sends datagrams to a port of the run, and is answered."""

    kind = socket.SOCK_DGRAM
    listened = True

    def poll(self) -> None:
        if self._blocker is not None:
            return
        if self.socket is None:
            self.socket = socket.socket(type=self.kind)
            self.socket.setblocking(False)
            self.socket.connect((HOST, self.port))
        if not self.received:
            self.send(self._hello)
        self._read()


class Receiver(_AtSocket):
    """A program at a port that the run sends datagrams to."""

    kind = socket.SOCK_DGRAM

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        super().__init__(folder, name, hello)
        self.socket = socket.socket(type=self.kind)
        self.socket.bind((HOST, self.port))
        self.socket.setblocking(False)
        self._from: tuple[str, int] | None = None

    def poll(self) -> None:
        assert self.socket is not None
        with contextlib.suppress(OSError):
            while True:
                data, self._from = self.socket.recvfrom(65536)
                self._keep(data)

    def send(self, data: bytes) -> None:
        if self._from is not None and self.socket is not None:
            with contextlib.suppress(OSError):
                self.socket.sendto(data, self._from)


class Firmware(Sender):
    """ArduPilot's simulated firmware: a frame, its answer, the next frame."""

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        super().__init__(folder, name, hello)
        self._count, self._answered = 0, 0

    def poll(self) -> None:
        self._hello = self._frame()
        super().poll()
        answers = self.received.count(b"}\n")
        if answers > self._answered:
            self._answered, self.received = 0, self.received[-2000:]
            self._answered = self.received.count(b"}\n")
            self._count += 1
            self.send(self._frame())

    def _frame(self) -> bytes:
        return struct.pack("<HHI16H", 18458, 50, self._count, *(1500,) * 16)


class Terminal(Peer):
    """The other end of a serial line: a terminal that is taken for a run's own."""

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        super().__init__(folder, name, hello)
        self._own, self._other = os.openpty()
        tty.setraw(self._other)
        os.set_blocking(self._own, False)
        self.device = os.ttyname(self._other)
        self._claim = claim(self.device)
        self._is_there = True

    def poll(self) -> None:
        with contextlib.suppress(OSError):
            while self._is_there and (data := os.read(self._own, 65536)):
                self._keep(data)

    def send(self, data: bytes) -> None:
        with contextlib.suppress(OSError):
            if self._is_there:
                os.write(self._own, data)

    def take(self) -> None:
        fcntl.flock(self._other, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def unplug(self) -> None:
        if self._is_there:
            self._is_there = False
            os.close(self._own)
            os.close(self._other)

    def close(self) -> None:
        self.unplug()
        if self._claim is not None:
            self._claim.close()


class Guest(Peer):
    """A program that opens a terminal of the run's: at a path of its own, or where it says."""

    def __init__(self, folder: Path, name: str, hello: bytes = b"") -> None:
        super().__init__(folder, name, hello)
        self.path, self._place = folder / f"{name}.tty", ""
        self._descriptor = -1

    def found(self, where: str) -> None:
        self._place = where

    def poll(self) -> None:
        place = self._place or str(self.path)
        if self._descriptor < 0 and (self._place or self.path.is_symlink()):
            try:
                self._descriptor = os.open(place, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
            except OSError:  # the run has just closed it
                return
            self.send(self._hello)
        with contextlib.suppress(OSError):
            while self._descriptor >= 0 and (data := os.read(self._descriptor, 65536)):
                self._keep(data)

    def send(self, data: bytes) -> None:
        with contextlib.suppress(OSError):
            if self._descriptor >= 0:
                os.write(self._descriptor, data)

    def take(self) -> None:
        self.path.write_text("something else")

    def left(self, *, orderly: bool) -> str:
        # A run that was killed leaves its link to the next one, which takes it away.
        return f"{self.path} is there" if orderly and self.path.is_symlink() else ""

    def close(self) -> None:
        if self._descriptor >= 0:
            os.close(self._descriptor)
