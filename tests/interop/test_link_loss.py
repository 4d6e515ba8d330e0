"""Parameters and long missions over a radio that loses a tenth of all, doubles and reorders."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from tests.kits.mavlink.ground import MISSION, Client, content, item, north_of

from .bad_link import bad_link
from .mavproxy import mavproxy
from .running import HOST, free_port, running, wait_for

ROOT = Path(__file__).parents[2]
ITEMS = 50
SYSTEM = 7
RETRY_S = 0.4
"""Wall time, more than the slowest answer takes."""
TRANSFER_S = 300.0
"""Wall time for a transfer; it takes seconds."""
FILE_DEG = 0.51e-6
"""Its files have six decimals."""


@pytest.fixture(scope="module")
def vehicle(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """Yield the port at which a running trial's vehicle listens."""
    port, folder = free_port(), tmp_path_factory.mktemp("loss")
    given = {
        "autopilot__mavlink__links": f"udpin:{HOST}:{port}",
        "autopilot__mavlink__system_id": str(SYSTEM),
    }
    with running("hydrone-mission", folder, factor=2.0, stop="6000 s", **given) as trial:
        wait_for(lambda: trial.is_running, "the trial's first step")
        yield port


def mission() -> list[mavlink.MAVLink_mission_item_int_message]:
    """Return home and waypoints on a spiral."""
    return [item(n, at=north_of(2.0 * n, 3.0 * n * (-1) ** n)) for n in range(ITEMS)]


class Station:
    """A ground station of pymavlink, at wall time."""

    def __init__(self, port: int) -> None:
        self.link = mavutil.mavlink_connection(f"udpout:{HOST}:{port}", dialect="all")
        self.client = Client(self.link.mav.send, RETRY_S)
        self.parameters: dict[int, tuple[str, float]] = {}
        self.count = 0
        self._asked = 0.0

    def run(self, done: str) -> None:
        """Listen and repeat until ``done``, a method, says so."""
        end = time.monotonic() + TRANSFER_S
        while not getattr(self, done)():
            assert time.monotonic() < end, f"{done}: not within {TRANSFER_S:g} s"
            message = self.link.recv_match(blocking=True, timeout=0.05)
            now = time.monotonic()
            if message is not None and message.get_type() == "PARAM_VALUE":
                self._keep(message)
            elif hasattr(message, "mission_type"):
                self.client.receive(message, now)
            self.client.tick(now)

    def has_uploaded(self) -> bool:
        return self.client.result is not None

    def has_downloaded(self) -> bool:
        return self.client.has_all

    def has_parameters(self) -> bool:
        """Ask for the list, then, when nothing more comes, for what is missing of it."""
        if time.monotonic() - self._asked > 1.0:
            self._asked = time.monotonic()
            if not self.parameters:
                self.link.mav.param_request_list_send(SYSTEM, 1)
            for index in [n for n in range(self.count) if n not in self.parameters][:10]:
                self.link.mav.param_request_read_send(SYSTEM, 1, b"", index)
        return 0 < self.count == len(self.parameters)

    def _keep(self, message: mavlink.MAVLink_param_value_message) -> None:
        self._asked, self.count = time.monotonic(), message.param_count
        known = self.parameters.setdefault(
            message.param_index, (message.param_id, message.param_value)
        )
        assert known == (message.param_id, message.param_value)  # an index stays what it is


def offered(port: int) -> dict[str, float]:
    """Return the parameters as they are sent over a link that loses nothing."""
    station = Station(port)
    station.run("has_parameters")
    station.link.close()
    return dict(station.parameters.values())


@pytest.mark.parametrize("seed", [1, *(pytest.param(n, marks=pytest.mark.long) for n in (2, 5))])
def test_a_station_gets_and_gives_all(vehicle: int, seed: int) -> None:
    with bad_link(vehicle, seed) as link:
        station, items = Station(link.port), mission()
        station.run("has_parameters")
        station.client.upload(items, MISSION, time.monotonic())
        station.run("has_uploaded")
        assert station.client.result == mavlink.MAV_MISSION_ACCEPTED
        station.client.download(MISSION, time.monotonic())
        station.run("has_downloaded")
        assert [content(m) for m in station.client.items[1:]] == [content(m) for m in items[1:]]
        station.link.close()
    assert dict(station.parameters.values()) == offered(vehicle)


@pytest.mark.long
def test_mavproxy_gets_and_gives_all(vehicle: int, tmp_path: Path) -> None:
    rows = [
        f"{m.seq}\t0\t3\t16\t0\t0\t0\t0\t{m.x * 1e-7:.7f}\t{m.y * 1e-7:.7f}\t0\t1\n"
        for m in mission()
    ]
    (tmp_path / "wp.txt").write_text("QGC WPL 110\n" + "".join(rows))
    count = len(offered(vehicle))
    with (
        bad_link(vehicle, 3) as link,
        mavproxy(tmp_path / "home", f"udpout:{HOST}:{link.port}") as proxy,
    ):
        proxy.expect(rf"Received {count} parameters", TRANSFER_S)
        proxy.insist(f"wp load {tmp_path / 'wp.txt'}", r"TYPE_MISSION: ACCEPTED", 20.0)
        saved = proxy.insist("wp list", rf"Saved {ITEMS} waypoints to (\S+)", 40.0)[1]
    listed = (tmp_path / "home" / saved).read_text().splitlines()[2:]
    assert [[float(x) for x in row.split()[8:10]] for row in listed] == [
        pytest.approx([m.x * 1e-7, m.y * 1e-7], abs=FILE_DEG) for m in mission()[1:]
    ]


@pytest.mark.long
def test_mavsdk_gets_and_gives_all(vehicle: int) -> None:
    places = [[m.x, m.y] for m in mission()]
    with bad_link(vehicle, 4) as link:
        module = "tests.interop.mavsdk_transfer"
        url = f"udpout://{HOST}:{link.port}"
        done = subprocess.run(
            [sys.executable, "-m", module, url, json.dumps(places)],
            cwd=ROOT, capture_output=True, text=True, timeout=2 * TRANSFER_S, check=False,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    got = json.loads(done.stdout.splitlines()[-1])
    assert got["parameters"] == pytest.approx(offered(vehicle), abs=1e-6)
    assert got["places"][1:] == places[1:]
