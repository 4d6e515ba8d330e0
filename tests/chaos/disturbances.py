"""Disturbances of a run: each function makes one, and has made it when it returns."""

from __future__ import annotations

import os
import random
import re
import signal
import socket
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress

from pymavlink.dialects.v20 import all as mavlink

from .rig import Episode

_LINGER = struct.pack("ii", 1, 0)
_STATION = mavlink.MAVLink(None, 255, 190)
_HEARTBEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(_STATION)
_DATA = {
    "socketcand": (b"< open can0 >< rawmode >", b"< send 0DF80102 8 1 2 3 4 5 6 7 8 >" * 50),
    "slcan": (b"O\r", b"T0DF8010281122334455667788\r" * 50),
    "link": (b"", _HEARTBEAT),
}


def opened(place: str) -> socket.socket:
    """Return a client at what a link said of itself."""
    kind = socket.SOCK_DGRAM if place.startswith("udp") else socket.SOCK_STREAM
    found = re.search(r"([\d.]+):(\d+)$", place)
    assert found is not None, place
    client = socket.socket(type=kind)
    client.settimeout(0.2)
    client.connect((found[1], int(found[2])))
    return client


def flood(episode: Episode, chance: random.Random) -> None:
    """Send to every link as fast as it takes, the vehicle's line too."""
    until = time.monotonic() + chance.uniform(0.5, 2.0)

    def send(name: str, place: str) -> None:
        hello, data = _DATA[name]
        with suppress(OSError), opened(place) as client:
            if hello:
                client.send(hello)
            while time.monotonic() < until:
                with suppress(TimeoutError):
                    client.send(data)

    def answer() -> None:
        os.set_blocking(episode.vehicle.own, False)
        while time.monotonic() < until:
            with suppress(BlockingIOError):
                os.write(episode.vehicle.own, bytes(4096))
            time.sleep(0.001)

    threads = [threading.Thread(target=answer)]
    for name, places in episode.places.items():
        threads += [threading.Thread(target=send, args=(name, place)) for place in places]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def vanish(episode: Episode, chance: random.Random) -> None:
    """Connect, send half of something, and be gone without a word."""
    for name, places in episode.places.items():
        for place in places:
            for _ in range(chance.randint(1, 20)):
                with suppress(OSError), opened(place) as client:
                    client.send(b"".join(_DATA[name])[: chance.randint(1, 60)])
                    if client.type == socket.SOCK_STREAM:
                        client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _LINGER)


def jump(episode: Episode, chance: random.Random) -> None:
    """Set the clock of the system to another hour, or another year."""
    episode.clock.write_text(f"{chance.choice([-31536000, -3600, -1, 1, 3600, 31536000]):+d}\n")
    time.sleep(0.5)


def suspend(episode: Episode, chance: random.Random) -> None:
    """Stop a process for a while, and let it go on before its run is taken for hung."""
    every = [pid for each in episode.processes().values() for pid in each]
    if every:
        pid = chance.choice(sorted(every))
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGSTOP)
            time.sleep(chance.uniform(0.05, 1.0))
            os.kill(pid, signal.SIGCONT)


def break_pipe(episode: Episode, chance: random.Random) -> None:
    """Let nobody read what the run prints."""
    episode.break_pipe()


def kill(part: str, *numbers: int) -> Callable[[Episode, random.Random], None]:
    """Return a function that ends one of the processes that are ``part`` of a run."""

    def kill(episode: Episode, chance: random.Random) -> None:
        if found := episode.processes()[part]:
            with suppress(ProcessLookupError):
                os.kill(chance.choice(sorted(found)), chance.choice(numbers))

    return kill


_CRASHES = signal.SIGKILL, signal.SIGSEGV
_STOPS = signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT
MILD = {"flood": flood, "vanish": vanish, "clock": jump, "suspend": suspend, "pipe": break_pipe}
"""A run goes on after these."""
LAST = {
    "child": kill("child", *_CRASHES),
    "worker": kill("worker", *_CRASHES),
    "board": kill("board", *_CRASHES),
    "supervisor": kill("supervisor", signal.SIGKILL),
    "stop": kill("supervisor", *_STOPS),
    "twice": kill("supervisor", *_STOPS),
}
"""One of these at most ends a run: nothing can act if all is killed at once."""
