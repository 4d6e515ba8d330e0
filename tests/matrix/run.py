"""A run of some link kinds, in a copy of this process: a start costs no imports."""

from __future__ import annotations

import contextlib
import csv
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

from seatrial.cli import main

from .kinds import Kind
from .peers import Peer

WAIT_S = 180.0
_PAUSE_S = 0.005
TALKER = '''
"""Bytes in every step; and a step that never ends, if that is wanted."""
import time

from seatrial.model.component import Component, Output, Parameter
from seatrial.links.text import Outbox


class Talker(Component):
    """Sends a byte in every step, which says full ahead."""

    tx = Output("1", "bytes", type=str)

    def start(self, t):
        self._tx = {}

    def step(self, t, h):
        box = Outbox(self._tx)
        box.put(self.now_ns, b"!")
        box.flush()

    def outputs(self, t):
        self.tx = Outbox(self._tx).text


class Hanging(Component):
    """Hangs from a time on."""

    hangs_at = Parameter(0.5, "s", "when")

    def step(self, t, h):
        while t > self.hangs_at:
            time.sleep(0.1)
'''
SKETCH = "void setup() { Serial.begin(115200); }\nvoid loop() { Serial.println(1); delay(20); }\n"


class Rig:
    """Files of a rig with links of some kinds, and the peers at their other ends."""

    def __init__(self, folder: Path, names: list[str], *, isolated: bool, hangs: bool) -> None:
        self.folder, self.kinds, self.peers = folder, dict[str, Kind](), dict[str, Peer]()
        for name in names:
            kind = Kind.of(name)
            assert kind is not None
            own = name.replace("-", "_").replace(" ", "_")
            self.kinds[own] = kind
            self.peers[own] = kind.peer(folder, own, kind.hello)
        self.longer = 1.5 if "ground-station" in names else 0.0
        """What a station needs more to beat again, s, if nobody was there at its first beat."""
        (folder / "talker.py").write_text(TALKER)
        (folder / "sketch").mkdir()
        (folder / "sketch" / "sketch.ino").write_text(SKETCH)
        (folder / "rig.toml").write_text(self._text(isolated, hangs))

    def write_trial(self, stop: float) -> None:
        """Write the trial, which ends at ``stop``, s, or where all links have had time to speak."""
        signals = [f"{own}.{kind.counter}" for own, kind in self.kinds.items() if kind.counter]
        listed = ", ".join(f'"{each}"' for each in [*signals, "wind.*"])
        (self.folder / "trial.toml").write_text(
            f'rig = "rig.toml"\nstop = "{stop + self.longer} s"\n[record]\nsignals = [{listed}]\n[real_time]\n'
        )

    def poll(self) -> None:
        """Let all peers do what is due."""
        for peer in self.peers.values():
            peer.poll()

    def silent(self) -> list[str]:
        """Return the links at whose other end nothing has been received, if there is one."""
        there = {own: peer for own, peer in self.peers.items() if type(peer) is not Peer}
        return [own for own, peer in there.items() if not peer.received]

    def left(self, *, orderly: bool) -> list[str]:
        """Return what is left behind of links."""
        found = (peer.left(orderly=orderly) for peer in self.peers.values())
        return [left for left in found if left]

    def close(self) -> None:
        """Close the peers."""
        for peer in self.peers.values():
            peer.close()

    def _text(self, isolated: bool, hangs: bool) -> str:
        lines = ['step = "20 ms"', "[components]", 'talker = { fmu = "talker.py:Talker" }']
        lines.append('wind = { fmu = "wind" }')  # has C
        if hangs:
            given = f"{{ hangs_at = {0.5 + self.longer} }}"
            lines.append(f'hanging = {{ fmu = "talker.py:Hanging", set = {given} }}')
        down = [own for own, kind in self.kinds.items() if kind.component == "serial-gateway"]
        buses = [own for own, kind in self.kinds.items() if kind.component == "can-gateway"]
        keys = "isolated = true, " if isolated else ""
        for own, kind in self.kinds.items():
            values = vars(self.peers[own])
            given = kind.set
            for key in ("port", "device", "path"):
                given = given.replace(f"{{{key}}}", str(values.get(key)))
            lines.append(f'{own} = {{ fmu = "{kind.component}", {keys}set = {{ {given} }} }}')
        if buses:
            nodes = " ".join(["traffic", *buses])
            lines.append(f'bus = {{ fmu = "canbus", set = {{ nodes = "{nodes}" }} }}')
            traffic = 'set = { messages = "0x0DF80102 0.02 8" }'
            lines.append(f'traffic = {{ fmu = "can-traffic", {traffic} }}')
        lines.append("[connections]")
        if down:
            ends = ", ".join(f'"{own}.rx"' for own in down)
            lines.append(f'"talker.tx" = [{ends}]')
        for number, own in enumerate(["traffic", *buses] if buses else [], 1):
            lines.append(f'"bus.n{number}" = "{own}.bus"')
        return "\n".join(lines) + "\n"


class Run:
    """``seatrial run`` of a rig, in a process of its own from here on."""

    def __init__(self, rig: Rig, carrier: str, *options: str) -> None:
        self._rig, self.folder = rig, rig.folder
        engine = {"isolated": "fmu", "live": "direct"}.get(carrier, carrier)
        arguments = ["seatrial", "run", "trial.toml", "--engine", engine, "--out", "run"]
        arguments += [*(["--live"] if carrier == "live" else []), "--no-report", *options]
        (self.folder / "tmp").mkdir()
        for name in ("stdout", "stderr"):
            (self.folder / name).touch()
        self.status: int | None = None
        self.pid = os.fork()
        if not self.pid:
            rig.close()  # a copy of a peer would keep its end open
            os._exit(_run(self.folder, arguments))

    def wait_for(self, holds: Callable[[], bool], what: str) -> None:
        """Poll the peers until something holds, or the run has ended."""
        deadline = time.monotonic() + WAIT_S
        while not holds() and not self.has_ended():
            assert time.monotonic() < deadline, f"{what}: {self._rig.silent()} {self.said}"
            self._tell()
            self._rig.poll()
            time.sleep(_PAUSE_S)

    def wait_until_received(self) -> None:
        """Poll until something has come from every link, and the run has its folder."""
        rows = self.folder / "run" / "signals.csv"
        self.wait_for(lambda: rows.exists() and not self._rig.silent(), "links are silent")
        assert not self.has_ended(), self.said

    def wait(self) -> int:
        """Wait for the end, and for what was sent until then; return the status."""
        self.wait_for(lambda: False, "it does not end")
        self._rig.poll()
        assert self.status is not None
        return self.status

    def has_ended(self) -> bool:
        """Say if it has ended."""
        if self.status is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.status = os.waitstatus_to_exitcode(status)
        return self.status is not None

    def child(self) -> int:
        """Return the process in which the components are: while a keeper is made, there are two."""
        until, found = time.monotonic() + WAIT_S, list[int]()
        while time.monotonic() < until:
            listed = Path(f"/proc/{self.pid}/task/{self.pid}/children").read_text().split()
            found = [int(pid) for pid in listed if not _has_ended(int(pid))]
            if len(found) == 1:
                return found[0]
            time.sleep(_PAUSE_S)
        raise AssertionError(f"{found} are the children of {self.pid}")

    @property
    def said(self) -> str:
        """What it has printed."""
        return (self.folder / "stdout").read_text() + (self.folder / "stderr").read_text()

    def last_row(self) -> dict[str, str]:
        """Return the last values of what was recorded."""
        with (self.folder / "run" / "signals.csv").open(newline="") as file:
            return list(csv.DictReader(file))[-1]

    def left(self, *, orderly: bool) -> list[str]:
        """Return what is left of it: processes, passing files, links."""
        deadline = time.monotonic() + WAIT_S
        while (there := self._processes()) and time.monotonic() < deadline:
            time.sleep(0.02)
        passing = map(str, (self.folder / "tmp").iterdir())
        return [*there, *passing, *self._rig.left(orderly=orderly)]

    def close(self) -> None:
        """End it whatever it does."""
        if not self.has_ended():
            os.kill(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)
        for line in self._processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(line.split()[0]), signal.SIGKILL)

    def _tell(self) -> None:
        """Tell peers where the run says that their links are."""
        lines = (self.folder / "stdout").read_text().splitlines()
        for name, where in pairwise(lines):
            own = name.removesuffix(": connect to")
            if own != name and own in self._rig.peers:
                self._rig.peers[own].found(where.strip())

    def _processes(self) -> list[str]:
        """Return numbers and names of processes that are at home in the run's folder."""
        found = []
        for place in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if Path(os.readlink(place / "cwd")).is_relative_to(self.folder):
                    found.append(f"{place.name} {(place / 'comm').read_text().strip()}")
        return found


def _run(folder: Path, arguments: list[str]) -> int:
    """Run a command as a process of its own would; return its status."""
    try:
        os.chdir(folder)
        for number, name in enumerate(("stdin", "stdout", "stderr")):
            opened = os.open(name if number else os.devnull, os.O_RDWR)
            os.dup2(opened, number)
        sys.stdin, sys.stdout, sys.stderr = map(open, (0, 1, 2), "rww")
        os.environ["TMPDIR"] = tempfile.tempdir = str(folder / "tmp")
        sys.argv = arguments
        main()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        sys.excepthook(*sys.exc_info())  # type: ignore[arg-type]
        return 99
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
    return 0


def _has_ended(pid: int) -> bool:
    """Return whether a process is gone, or waited for by nobody yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2].startswith("Z")
    except FileNotFoundError:
        return True
