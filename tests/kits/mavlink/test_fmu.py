"""The component as an FMU: in this process, in one of its own, and in libcosim."""

import contextlib
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pymavlink import mavutil

from seatrial.fmi.building.bundle import bundled
from seatrial.fmi.building.export import cached_fmu
from seatrial.fmi.components.source import find_source
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.mavlink.component import Mavlink

WAIT_S = 30.0
OUTPUTS = ["mode", "armed", "manual.surge", "target_valid", "home.north", "ground_stations"]


@pytest.fixture(scope="module")
def fmu():
    """Return the component's FMU, built on demand as a run does."""
    source = find_source("mavlink", Path.cwd())
    return load_fmu(cached_fmu(source, bundled(source).script))


def opened(how, fmu):
    if how == "in process":
        return DirectInstance(Mavlink("link"))
    return open_instance(fmu, "link") if how == "fmu" else IsolatedInstance(fmu, "link", 60.0)


@pytest.fixture
def station():
    """Yield a ground station that listens, and the URL at which it does."""
    connection = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    yield connection, f"udpout:127.0.0.1:{connection.port.getsockname()[1]}"
    connection.close()


def started(instance, **values):
    places = ("position_n.north", "position_n.east", "position_n.down")
    measured = dict.fromkeys((*places, "heading", "roll_pitch.phi", "roll_pitch.theta"), 0.0)
    instance.set_start({**measured, "position_valid": True, **values})
    instance.initialise(0.0, 1e6)
    instance.begin()
    return instance


def sockets():
    """Return the number of sockets that this process has open."""
    links = []
    for each in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):
            links.append(os.readlink(each))
    return sum(link.startswith("socket:") for link in links)


CARRIERS = ["in process", "fmu", "isolated"]


@pytest.mark.parametrize("how", CARRIERS)
def test_a_ground_station_arms_and_drives_it(how, fmu, station):
    connection, url = station
    instance = started(opened(how, fmu), links=url)
    read = instance.reader(["armed", "mode", "manual.surge"])
    try:
        deadline, k = time.monotonic() + WAIT_S, 0
        while read() != [True, "manual", 0.5]:
            assert time.monotonic() < deadline
            instance.step(k / 100, 0.01)
            k += 1
            if connection.recv_match(type="HEARTBEAT") is not None:
                connection.mav.heartbeat_send(6, 8, 0, 0, 4)
                connection.arducopter_arm()
                connection.set_mode("MANUAL")
                connection.mav.manual_control_send(1, 0, 0, 500, 0, 0)
            time.sleep(0.0005)
    finally:
        instance.free()


def test_the_carriers_agree_when_nobody_is_there(fmu):
    def run(how):
        instance = started(opened(how, fmu), links="udpin:127.0.0.1:0", latitude=0.5)
        read, rows = instance.reader(OUTPUTS), []
        for k in range(200):
            instance.step(k / 100, 0.01)
            rows.append(read())
        instance.free()
        return rows

    assert run("in process") == run("fmu") == run("isolated")


@pytest.mark.parametrize("how", ["in process", "fmu"])
@pytest.mark.parametrize("end", ["terminate", "free"])
def test_its_sockets_are_closed_at_the_end(how, end, fmu):
    before = sockets()
    instance = started(opened(how, fmu), links="udpin:127.0.0.1:0 tcpin:127.0.0.1:0")
    assert sockets() == before + 2
    if end == "terminate":
        instance.step(0.0, 0.01)
        instance.terminate()
        assert sockets() == before
    instance.free()
    assert sockets() == before


def test_it_says_that_it_cannot_be_rolled_back(fmu):
    capabilities = fmu.description.coSimulation
    assert not capabilities.canGetAndSetFMUstate
    assert not capabilities.canSerializeFMUstate


@pytest.mark.interop
def test_libcosim_runs_it(fmu, station):
    connection, url = station
    reference = {v.name: v.reference for v in fmu.variables.values()}
    slave = {
        "name": "link",
        "path": str(fmu.path),
        **{kind: {} for kind in ("real", "integer", "boolean", "string")},
    }
    slave["string"] = {reference["links"]: url}
    watch = [["link", [reference["home.north"]]]]
    job = {"slaves": [slave], "connections": [], "step": 0.01, "steps": 150, "watch": watch}
    subprocess.run(
        [sys.executable, "-m", "tests.interop.libcosim_run"],
        input=json.dumps(job), text=True, capture_output=True, check=True, timeout=120,
        cwd=Path(__file__).parents[3],
    )  # fmt: skip
    beats = 0
    while (message := connection.recv_match()) is not None:
        beats += message.get_type() == "HEARTBEAT"
    assert beats == 3  # at 0 and at 1 s of 1.5, and the last when it closes


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_the_rig_runs_with_nobody_there_and_is_the_same_each_time(engine, write, tmp_path):
    text = 'rig = "sil"\nchoices = { autopilot = "mavlink" }\nstop = "1 s"\n[set]\n"autopilot.mavlink.links" = ""\n'
    trial = load_trial(str(write("short.toml", text)))
    records = []
    for name in ("one", "two"):
        result = run_trial(trial, tmp_path / name, engine=engine)
        assert result.status == "complete"
        records.append((result.folder / "signals.csv").read_bytes())
    assert records[0] == records[1]
    assert len(records[0].splitlines()) == 102
