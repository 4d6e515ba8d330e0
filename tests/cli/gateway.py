"""A vehicle behind a serial gateway, its rig, and what ends a run of it."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import tty
from collections.abc import Callable

import pytest

SAFE = bytes.fromhex("FAAF0100000F5B0000000000000000000000FFFFFFFF00")
TALKER = '''
"""Sends, and may be slow to start."""
import time

from seatrial.model.component import Component, Output, Parameter
from seatrial.links.text import Outbox


class Talker(Component):
    """Sends a byte in every step, which says full ahead."""

    start_takes = Parameter(0.0, "s", "wall time of the start")
    tx = Output("1", "bytes", type=str)

    def start(self, t):
        self._tx = {}
        time.sleep(self.start_takes)

    def step(self, t, h):
        box = Outbox(self._tx)
        box.put(self.now_ns, b"!")
        box.flush()

    def outputs(self, t):
        self.tx = Outbox(self._tx).text
'''
RIG = """
step = "10 ms"
[components]
port = {{ fmu = "serial-gateway", isolated = {isolated}, set = {{ links = "serial:{device}:115200", safe_state = "{safe}" }} }}
talker = {{ fmu = "talker.py:Talker", set = {{ start_takes = {start_takes} }} }}
[connections]
"talker.tx" = "port.rx"
"""
ENDS = [
    pytest.param("supervisor", signal.SIGINT, id="int"),
    pytest.param("supervisor", signal.SIGTERM, id="term", marks=pytest.mark.interop),
    pytest.param("supervisor", signal.SIGHUP, id="hup"),
    pytest.param("supervisor", signal.SIGQUIT, id="quit", marks=pytest.mark.interop),
    pytest.param("supervisor", signal.SIGKILL, id="supervisor-killed", marks=pytest.mark.interop),
    pytest.param("child", signal.SIGKILL, id="killed"),
    pytest.param("child", signal.SIGSEGV, id="segfault", marks=pytest.mark.interop),
]


class Vehicle:
    """The other end of a line: a pseudo-terminal, and what has come from it."""

    def __init__(self) -> None:
        self._own, self._other = os.openpty()
        tty.setraw(self._other)
        self.device = os.ttyname(self._other)
        self.received = b""

    def read(self) -> bytes:
        while select.select([self._own], [], [], 0.0)[0]:
            self.received += os.read(self._own, 65536)
        return self.received

    def close(self) -> None:
        os.close(self._own)
        os.close(self._other)


Start = Callable[..., subprocess.Popen[str]]
Launched = Callable[..., subprocess.Popen[str]]
