"""gpsd reads the feed over TCP and reports what it understood."""

import contextlib
import json
import math
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator

import pymap3d
import pytest

from seatrial_kits.nmea.nmea0183.component import Nmea0183

DEG = math.pi / 180.0
WAIT_S = 60.0


@pytest.fixture
def feed() -> Iterator[Nmea0183]:
    one = Nmea0183("nmea")
    for name, value in {
        "links": "tcpin:127.0.0.1:0",
        "sentences": "GPRMC 0.5; GPGGA 0.5; GPVTG 0.5; HCHDG 0.5; SDDBT 0.5",
        "latitude": -22.862 * DEG,
        "longitude": -43.223 * DEG,
        "altitude": 2.0,
        "variation": -23.0 * DEG,
        "date": "2026-09-01",
        "position_n": [100.0, -50.0, -1.5],
        "velocity_n": [1.0, -0.5, 0.1],
        "position_valid": True,
        "heading": 350.0 * DEG,
        "heading_valid": True,
        "depth": 12.34,
        "depth_valid": True,
    }.items():
        one.set(name, value)
    one.initialise()
    one.begin()
    yield one
    one.close()


@contextlib.contextmanager
def reports(feed: Nmea0183) -> Iterator[socket.socket]:
    """Run gpsd, and return a connection on which it says what it reads."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    source = f"tcp://{feed.get('reached_at').removeprefix('tcp:')}"
    command = ["gpsd", "-N", "-n", "-b", "-S", str(port), source]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as gpsd:
        try:
            deadline = time.monotonic() + WAIT_S
            while True:
                try:
                    client = socket.create_connection(("127.0.0.1", port))
                    break
                except OSError:
                    assert time.monotonic() < deadline
                    time.sleep(0.05)
            with client:
                client.sendall(b'?WATCH={"enable":true,"json":true};\n')
                client.setblocking(False)
                yield client
        finally:
            gpsd.terminate()


@pytest.mark.long
def test_gpsd_understands_it(feed):
    assert shutil.which("gpsd"), "gpsd is needed: on Debian, apt install gpsd"
    found: dict = {}
    with reports(feed) as client:
        waiting, step, deadline = b"", 0, time.monotonic() + WAIT_S
        while not {"lat", "track", "magvar", "depth"} <= set(found):
            assert time.monotonic() < deadline, found
            feed.advance(step * 0.05, 0.05)
            step += 1
            time.sleep(0.05)  # gpsd recognises sentences of one instant by the pause after them
            with contextlib.suppress(BlockingIOError):
                waiting += client.recv(65536)
            *lines, waiting = waiting.split(b"\n")
            for each in map(json.loads, filter(None, lines)):
                found.update(each if each["class"] == "TPV" else {})
    latitude, longitude, _ = pymap3d.ned2geodetic(100.0, -50.0, 0.0, -22.862, -43.223, 2.0)
    assert found["mode"] == 3
    assert found["time"].startswith("2026-09-01T00:0")
    assert found["lat"] == pytest.approx(latitude, abs=2e-7)
    assert found["lon"] == pytest.approx(longitude, abs=2e-7)
    assert found["altMSL"] == pytest.approx(3.5)
    assert found["speed"] == pytest.approx(math.hypot(1.0, 0.5), abs=0.005)
    assert found["track"] == pytest.approx(360.0 - math.degrees(math.atan2(0.5, 1.0)), abs=0.01)
    assert found["magvar"] == pytest.approx(-23.0)
    assert found["magtrack"] == pytest.approx(13.0)
    assert found["depth"] == pytest.approx(12.34)
