"""The rig that everything happens to, and a run of it by the command line."""

from __future__ import annotations

import os
import random
import re
import select
import subprocess
import threading
import time
import tty
from pathlib import Path
from typing import Any

from tests.command import SEATRIAL

from ..fmi.native import build_native_fmu

SAFE = bytes.fromhex("FAAF0100000F5B0000000000000000000000FFFFFFFF00")
MARK = "SEATRIAL_CHAOS_MARK"
"""Environment variable by which every process of an episode is found."""
WAIT_S = 90.0
TALKER = '''
"""Sends a byte in every step, which says full ahead."""
from seatrial.model.component import Component, Output
from seatrial.links.text import Outbox


class Talker(Component):
    """Counts what it has sent."""

    tx = Output("1", "bytes", type=str)
    sent = Output("1", "bytes sent", type=int)

    def start(self, t):
        self._tx, self.count = {}, 0

    def step(self, t, h):
        box = Outbox(self._tx)
        box.put(self.now_ns, b"!")
        box.flush()
        self.count += 1

    def outputs(self, t):
        self.tx, self.sent = Outbox(self._tx).text, self.count
'''
SKETCH = (
    "void setup() { Serial.begin(115200); }\nvoid loop() { Serial.println(millis()); delay(50); }\n"
)
RIG = """
step = "20 ms"
[components]
talker = {{ fmu = "talker.py:Talker", isolated = {talker} }}
port   = {{ fmu = "serial-gateway", isolated = {port}, set = {{ links = "serial:{device}:115200", safe_state = "{safe}" }} }}
native = {{ fmu = "crash.fmu", isolated = true }}
board  = {{ fmu = "arduino", set = {{ backend = "{backend}", sketch = "sketch" }} }}
link   = {{ fmu = "mavlink", set = {{ links = "tcpin:127.0.0.1:0 udpin:127.0.0.1:0" }} }}
can    = {{ fmu = "canbus", set = {{ nodes = "traffic socketcand slcan" }} }}
traffic    = {{ fmu = "can-traffic", set = {{ messages = "0x0DF80102 0.01 8" }} }}
socketcand = {{ fmu = "can-gateway", set = {{ link = "socketcand:127.0.0.1:0", safe_state = "123#" }} }}
slcan      = {{ fmu = "can-gateway", set = {{ link = "slcan-tcp:127.0.0.1:0", safe_state = "123#" }} }}
[connections]
"talker.tx" = "port.rx"
"can.n1" = "traffic.bus"
"can.n2" = "socketcand.bus"
"can.n3" = "slcan.bus"
"""
TRIAL = """
rig = "rig.toml"
stop = "{stop} s"
[record]
signals = ["talker.sent", "port.received", "native.*", "board.bytes_sent", "link.*", "can.*"]
[real_time]
[[criteria]]
name = "it talks"
check = "finally talker.sent > {least}"
"""
FULL_DISK = (
    'mount -t tmpfs -o size="$1" none disk || exit 99; shift; '
    '"$@"; status=$?; cp -r disk left; exit $status'
)
LINKS = {"link", "socketcand", "slcan"}
"""Components that programs connect to."""
_CONNECT = re.compile(r"^(\w+): connect to$")


class Vehicle:
    """The other end of a line, which is always read: the last bytes that came from it."""

    def __init__(self) -> None:
        self.own, self._other = os.openpty()
        tty.setraw(self._other)
        self.device = os.ttyname(self._other)
        self.received = b""
        self._over = False
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def close(self) -> None:
        self._over = True
        self._thread.join()
        os.close(self.own)
        os.close(self._other)

    def _read(self) -> None:
        while not self._over:
            if select.select([self.own], [], [], 0.05)[0]:
                self.received = (self.received + os.read(self.own, 65536))[-4096:]


class Episode:
    """One run, in a folder of its own, with what is known of it."""

    def __init__(self, folder: Path, number: int, chance: random.Random, kinds: list[str]) -> None:
        self.folder, self.kinds, self.vehicle = folder, kinds, Vehicle()
        self.mark = f"{os.getpid()}-{number}"
        self.clock, self.temporary = folder / "clock", folder / "tmp"
        self.places: dict[str, list[str]] = {}
        self._memory = _shared_memory()
        self.out, self.output = folder / "run", ""
        self._write(chance)
        engine = chance.choice(["fmu", "direct"])
        command = [SEATRIAL, "run", "trial.toml", "--hardware", "--engine", engine, "--out"]
        if "full disk" in kinds:
            (folder / "disk").mkdir()
            self.out = folder / "left" / "run"
            size = f"{chance.randint(100, 1500)}k"
            command = ["unshare", "-Urm", "sh", "-c", FULL_DISK, "sh", size, *command, "disk/run"]
        else:
            command.append("run")
        self.process = subprocess.Popen(
            command, cwd=folder, env=self._environment(), text=True,
            stdout=subprocess.PIPE, stderr=(folder / "stderr").open("w"),
        )  # fmt: skip
        self._reader = threading.Thread(target=self._read_places)
        self._reader.start()

    @property
    def message(self) -> str:
        """What came on stderr."""
        return (self.folder / "stderr").read_text("utf-8", "replace")

    def wait_until_reachable(self) -> bool:
        """Return whether all links have said where they are, before the run's end."""
        deadline = time.monotonic() + WAIT_S
        while self.places.keys() != LINKS and self.process.poll() is None:
            assert time.monotonic() < deadline, f"it does not start: {self.output}{self.message}"
            time.sleep(0.05)
        return self.process.poll() is None

    def break_pipe(self) -> None:
        """Let nobody read stdout any more."""
        self._broken = True

    def processes(self) -> dict[str, list[int]]:
        """Return its processes by their part: supervisor, child, worker, board."""
        names = ("supervisor", "child", "keeper", "worker", "board")
        found: dict[str, list[int]] = {name: [] for name in names}
        marked = dict(_marked(self.mark))
        for pid, parent in marked.items():
            line = _command_line(pid)
            if line.startswith("keeper-of-links"):
                found["keeper"].append(pid)
            elif "sketches/" in line:
                found["board"].append(pid)
            elif line.startswith(("unshare ", "sh ")):
                continue
            elif not _is_run(line):
                found["worker"].append(pid)
            elif parent in marked and _is_run(_command_line(parent)):
                found["child"].append(pid)
            else:
                found["supervisor"].append(pid)
        return found

    def left_processes(self) -> list[str]:
        """Return the command lines of processes that live."""
        return [_command_line(pid) for pid, _ in _marked(self.mark)]

    def left_memory(self) -> list[str]:
        """Return the names of shared memory that is there since it began, POSIX and System V."""
        return sorted(_shared_memory() - self._memory)

    def close(self) -> None:
        self.process.wait()
        self._reader.join()
        self.vehicle.close()

    # ------------------------------------------------------------------ inside

    def _write(self, chance: random.Random) -> None:
        self.temporary.mkdir(parents=True)
        (self.folder / "sketch").mkdir()
        (self.folder / "sketch" / "sketch.ino").write_text(SKETCH)
        (self.folder / "talker.py").write_text(TALKER)
        (self.folder / "crash.fmu").symlink_to(self.folder.parent / "crash.fmu")
        values: dict[str, Any] = {
            "talker": str(chance.random() < 0.5).lower(),
            "port": str(chance.random() < 0.5).lower(),
            "backend": chance.choice(["host", "simavr"]),
        }
        text = RIG.format(device=self.vehicle.device, safe=SAFE.hex(), **values)
        (self.folder / "rig.toml").write_text(text)
        trial = TRIAL.format(stop=chance.choice([8, 20]), least=chance.choice([0, 10**6]))
        (self.folder / "trial.toml").write_text(trial)
        self.clock.write_text("+0\n")

    def _environment(self) -> dict[str, str]:
        environment = {
            **os.environ,
            MARK: self.mark,
            "TMPDIR": str(self.temporary),
            "PYTHONUNBUFFERED": "1",
        }
        if "clock" in self.kinds:
            environment["LD_PRELOAD"] = str(self.folder.parent / "clock.so")
            environment["CHAOS_CLOCK"] = str(self.clock)
        return environment

    def _read_places(self) -> None:
        stdout, name = self.process.stdout, ""
        assert stdout is not None
        self._broken = False
        os.set_blocking(stdout.fileno(), False)
        text = ""
        while not self._broken:
            if not select.select([stdout], [], [], 0.05)[0]:
                continue
            data = os.read(stdout.fileno(), 65536).decode()
            if not data:
                break
            self.output += data
            *lines, text = (text + data).split("\n")
            for line in lines:
                if found := _CONNECT.match(line):
                    name = found[1]
                elif name in LINKS and line.startswith("  "):
                    self.places.setdefault(name, []).append(line.strip())
        stdout.close()


def prepare(folder: Path) -> None:
    """Build what all episodes share."""
    build_native_fmu("crash", folder)
    source = Path(__file__).with_name("clock.c")
    command = ["cc", "-shared", "-fPIC", "-O1", source, "-o", folder / "clock.so"]
    subprocess.run(command, check=True)


def _marked(mark: str) -> list[tuple[int, int]]:
    """Return numbers and parents of the processes with a mark that have not ended."""
    wanted, found = f"{MARK}={mark}".encode(), []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (place / "environ").read_bytes().split(b"\0"):
                state, parent = (place / "stat").read_text().rpartition(")")[2].split()[:2]
                if state != "Z":
                    found.append((int(place.name), int(parent)))
        except OSError:  # it has ended meanwhile
            continue
    return found


def _shared_memory() -> set[str]:
    segments = Path("/proc/sysvipc/shm").read_text().splitlines()[1:]
    return {*os.listdir("/dev/shm"), *(f"System V {line.split()[1]}" for line in segments)}


def _is_run(line: str) -> bool:
    """Say if a command line is that of ``seatrial run``, and not of what starts it."""
    return " run trial.toml " in line and not line.startswith(("unshare ", "sh "))


def _command_line(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""
