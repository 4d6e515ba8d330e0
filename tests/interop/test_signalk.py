"""A Signal K server reads a running trial through the gateway, and serves it over HTTP.

It is not installed with the other reference tools: 600 packages. Where it is, SIGNALK_SERVER names the folder
whose node_modules have it (npm install --ignore-scripts signalk-server).
"""

import json
import math
import os
import shutil
import subprocess
import time
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from .running import HOST, free_port, running, wait_for

SERVER = Path(os.environ.get("SIGNALK_SERVER", "/nowhere"), "node_modules/signalk-server")
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(
        shutil.which("node") is None or not SERVER.is_dir(),
        reason="SIGNALK_SERVER names no folder with a Signal K server",
    ),
]
SELF = "signalk/v1/api/vessels/self"


def configured(folder: Path, port: int, gateway: int) -> None:
    options = {"type": "ydwg02-canboatjs", "host": HOST, "port": str(gateway)}
    element = {"type": "providers/simple", "options": {"type": "NMEA2000", "subOptions": options}}
    settings = {
        "interfaces": {"nmea-tcp": False, "tcp": False, "mfd_webapp": False},
        "pipedProviders": [{"id": "ship", "enabled": True, "pipeElements": [element]}],
        "port": port,
        "ssl": False,
        "mdns": False,
    }
    (folder / "settings.json").write_text(json.dumps(settings), "utf-8")
    (folder / "package.json").write_text('{"name": "signalk-config", "version": "0.0.1"}', "utf-8")
    vessel = {
        "vessels": {"self": {"uuid": "urn:mrn:signalk:uuid:c0d79334-4e25-4245-8892-54e8ccc8021d"}}
    }
    (folder / "baseDeltas.json").write_text("[]", "utf-8")
    (folder / "defaults.json").write_text(json.dumps(vessel), "utf-8")


def asked(port: int, path: str):
    """Return what the server has at a path, None if it has nothing yet."""
    url = f"http://{HOST}:{port}/{SELF}/{path.replace('.', '/')}"
    try:
        with urllib.request.urlopen(url, timeout=10) as answer:
            return json.load(answer)
    except (urllib.error.URLError, ConnectionError, TimeoutError):
        return None


def test_the_server_shows_the_ship(tmp_path):
    port, gateway = (free_port() for _ in range(2))
    config = tmp_path / "config"
    config.mkdir()
    configured(config, port, gateway)
    gateway = f"yd-raw-tcp:{HOST}:{gateway}"
    environment = {**os.environ, "SIGNALK_NODE_CONFIG_DIR": str(config), "NODE_ENV": "production"}
    with (
        running("mariner-nmea2000-live", tmp_path, gateway__link=gateway) as trial,
        (tmp_path / "server.txt").open("wb") as log,
    ):
        wait_for(lambda: trial.is_running, "the trial runs", 180.0)
        server = subprocess.Popen(
            ["node", str(SERVER / "bin/signalk-server"), "-c", str(config)],
            None,
            None,
            None,
            log,
            subprocess.STDOUT,
            env=environment,
            cwd=config,
        )
        try:
            begun = time.monotonic()
            wait_for(lambda: asked(port, "navigation.headingTrue"), "a heading", 240.0)
            print(f"a heading after {time.monotonic() - begun:.0f} s")
            wait_for(lambda: asked(port, "environment.depth.belowTransducer"), "a depth")
            wait_for(lambda: asked(port, "environment.wind.speedApparent"), "a wind")
            wait_for(lambda: asked(port, "navigation.position"), "a position")
            shown = {path: asked(port, path) for path in PATHS}
        except BaseException as error:
            error.add_note((tmp_path / "server.txt").read_text("utf-8", "replace")[-3000:])
            raise
        finally:
            server.terminate()
            server.wait(60)
        trial.stop()
    print({path: each and each["value"] for path, each in shown.items()})
    # She goes ahead at 15 knots on course 0 from the origin of her profile, rudder near amidships.
    assert math.isclose(
        math.remainder(shown["navigation.headingTrue"]["value"], math.tau), 0, abs_tol=0.02
    )
    assert shown["navigation.headingTrue"]["pgn"] == 127250
    assert abs(shown["navigation.rateOfTurn"]["value"]) < 1e-3
    assert abs(shown["steering.rudderAngle"]["value"]) < 0.05
    position = shown["navigation.position"]["value"]
    assert position["longitude"] == pytest.approx(-43.17, abs=3e-4)
    assert -23.0501 < position["latitude"] < -23.0
    assert shown["environment.depth.belowTransducer"]["value"] == 60.0
    assert shown["navigation.speedThroughWater"]["value"] == pytest.approx(7.72, abs=0.05)
    assert shown["navigation.speedOverGround"]["value"] == pytest.approx(7.72, abs=0.3)
    # Wind from the north at 8 m/s, ship to the north: both add up, from ahead.
    assert shown["environment.wind.speedApparent"]["value"] == pytest.approx(15.7, abs=0.6)
    assert abs(shown["environment.wind.angleApparent"]["value"]) < 0.15
    assert shown["navigation.datetime"]["value"].startswith("1979-12-01T00:")


PATHS = (
    *("navigation.headingTrue", "navigation.rateOfTurn", "steering.rudderAngle"),
    *("navigation.position", "navigation.speedThroughWater", "navigation.speedOverGround"),
    *("environment.depth.belowTransducer", "environment.wind.speedApparent"),
    *("environment.wind.angleApparent", "navigation.datetime"),
)
