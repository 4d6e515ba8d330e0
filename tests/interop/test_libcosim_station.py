"""A ground station at the component's FMU while libcosim runs it, in real time."""

from __future__ import annotations

import json
import select
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from seatrial.fmi.building.bundle import bundled
from seatrial.fmi.building.export import cached_fmu
from seatrial.fmi.components.source import find_source
from seatrial.fmi.loading.load import load_fmu

from .running import HOST, free_port

ROOT = Path(__file__).parents[2]
WAIT_S = 60.0
WATCHED = {
    "string": ["mode"],
    "boolean": ["armed"],
    "integer": ["ground_stations"],
    "real": ["manual.surge", "home.north"],
}


class Libcosim:
    """An FMU in libcosim, in a process of its own, and what it reads of it."""

    def __init__(self, port: int) -> None:
        source = find_source("mavlink", Path.cwd())
        script = bundled(source).script
        fmu = load_fmu(cached_fmu(source, script))
        number = {v.name: v.reference for v in fmu.variables.values()}
        self._names = {number[name]: name for names in WATCHED.values() for name in names}
        measured = [
            v for v in number if v.startswith(("position_n.", "velocity_n.")) or v == "heading"
        ]
        slave: dict[str, Any] = {"name": "link", "path": str(fmu.path), "integer": {}}
        slave |= {"real": dict.fromkeys((number[name] for name in measured), 0.0)}
        slave |= {"boolean": {number["position_valid"]: True}}
        slave |= {"string": {number["links"]: f"udpin:{HOST}:{port}"}}
        watch = {kind: [["link", number[n]] for n in names] for kind, names in WATCHED.items()}
        job = {"slaves": [slave], "connections": [], "step": 0.01, "watch": watch, "port": port}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.interop.libcosim_live"],
            cwd=ROOT, text=True, bufsize=1, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip
        self.send_line(json.dumps(job))

    def send_line(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def line(self) -> str:
        """Return the next line that it prints."""
        assert self.process.stdout is not None
        assert select.select([self.process.stdout], [], [], WAIT_S)[0], "libcosim says nothing"
        return self.process.stdout.readline().strip()

    def values(self) -> dict[str, Any]:
        """Return the values of the next 0.1 s by name."""
        return {self._names[int(key)]: value for key, value in json.loads(self.line()).items()}


def until(
    libcosim: Libcosim, say: Callable[[], None], condition: Callable[[dict[str, Any]], bool]
) -> None:
    """Say something again and again until the FMU's outputs are as they should be."""
    end = time.monotonic() + WAIT_S
    while not condition(values := libcosim.values()):
        assert time.monotonic() < end, values
        say()


def test_a_station_commands_it_and_libcosim_sees_it() -> None:
    port = free_port()
    libcosim = Libcosim(port)
    try:
        assert libcosim.values() == {
            "mode": "hold", "armed": False, "ground_stations": 0, "manual.surge": 0.0,
            "home.north": 0.0,
        }  # fmt: skip
        station = mavutil.mavlink_connection(f"udpout:{HOST}:{port}", dialect="all")
        beat = lambda: station.mav.heartbeat_send(6, 8, 0, 0, 4)  # noqa: E731
        until(libcosim, beat, lambda v: v["ground_stations"] == 1)
        received = station.recv_match(type="HEARTBEAT", blocking=True, timeout=WAIT_S)
        assert (received.type, received.autopilot) == (mavlink.MAV_TYPE_SURFACE_BOAT, 3)

        station.mav.param_request_list_send(1, 1)
        names, count = set(), None
        while count is None or len(names) < count:
            value = station.recv_match(type="PARAM_VALUE", blocking=True, timeout=WAIT_S)
            names, count = names | {value.param_id}, value.param_count
        assert {"FS_ACTION", "SYSID_THISMAV"} < names

        station.wait_heartbeat()
        until(libcosim, station.arducopter_arm, lambda v: v["armed"])
        ack = station.recv_match(type="COMMAND_ACK", blocking=True, timeout=WAIT_S)
        assert (ack.command, ack.result) == (400, mavlink.MAV_RESULT_ACCEPTED)
        until(libcosim, lambda: station.set_mode("MANUAL"), lambda v: v["mode"] == "manual")
        deflect = lambda: station.mav.manual_control_send(1, 0, 0, 500, 0, 0)  # noqa: E731
        until(libcosim, deflect, lambda v: v["manual.surge"] == 0.5)
        station.mav.set_home_position_send(
            1, round(1e-3 * 1e7), 0, 0, 0.0, 0.0, 0.0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0
        )
        until(libcosim, beat, lambda v: abs(v["home.north"] - 110.57) < 0.01)  # 0.001 degree

        libcosim.send_line("stop")
        while (last := libcosim.line()).startswith("{"):
            pass
        assert last == "free"
        station.close()
    finally:
        libcosim.process.kill()
        libcosim.process.wait()
