"""The component in rigs: its log beside the run, its tunables on connections."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from pymavlink import mavutil

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

GAIN = '''
"""A controller."""
from seatrial.model.component import Component, Output, Parameter


class Controller(Component):
    """Shows its gain."""

    gain = Parameter(1.0, "N/m", "gain", max=20.0, tunable=True)
    shown = Output("N/m", "the gain")

    def outputs(self, t):
        self.shown = self.gain
'''
MIDNIGHT = 1_770_249_600  # 2026-02-05, s


@pytest.fixture
def listener() -> Iterator[int]:
    """Return a UDP port at which a socket listens and sends nothing."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as bound:
        bound.bind(("127.0.0.1", 0))
        yield bound.getsockname()[1]


def trial(write, port: int, options: str = "", component: str = "") -> str:
    write(
        "rig.toml",
        f"""step = "10 ms"
[components]
boat = {{ fmu = "mavlink"{component}, set = {{ links = "udpout:127.0.0.1:{port}", date = "2026-02-05"{options} }} }}
""",
    )
    return str(write("trial.toml", 'rig = "rig.toml"\nstop = "5 s"\nstart = "2 s"\n'))


@pytest.mark.slow
def test_the_log_is_beside_the_run_and_the_same_in_every_carrier(
    write, listener: int, tmp_path: Path
) -> None:
    logs = []
    for name, engine, component in (
        ("a", "direct", ""), ("b", "fmu", ""), ("c", "fmu", ", isolated = true"),
    ):  # fmt: skip
        loaded = load_trial(trial(write, listener, component=component))
        result = run_trial(loaded, tmp_path / name, engine=engine)
        assert result.status == "complete"
        assert not any("run_folder" in note for note in result.notes)
        manifest = json.loads((result.folder / "manifest.json").read_text())
        assert manifest["components"]["boat"]["parameters"]["run_folder"]["value"] == ""
        logs.append((result.folder / "boat.tlog").read_bytes())
    assert logs[0] == logs[1] == logs[2]
    reader = mavutil.mavlink_connection(str(tmp_path / "a" / "boat.tlog"), dialect="all")
    beats = []
    while (message := reader.recv_match(type="HEARTBEAT")) is not None:
        beats.append(message._timestamp)
    reader.close()
    # A second apart, counted from the start of the run; and one at the end of the last step.
    expected = [*(MIDNIGHT + k for k in range(3)), MIDNIGHT + 2.99]
    assert beats == pytest.approx(expected, abs=1e-5)


def test_a_folder_that_was_set_is_kept(write, listener: int, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    text = trial(write, listener, f', run_folder = "{tmp_path / "logs"}"')
    folder = run_trial(load_trial(text), tmp_path / "run", engine="direct").folder
    assert (tmp_path / "logs" / "boat.tlog").stat().st_size > 1000
    assert not (folder / "boat.tlog").exists()


RIG = """step = "10 ms"
[components]
boat = {{ fmu = "mavlink", set = {{ links = "udpin:127.0.0.1:0", tunables = "{tunables}", parameter_file = "{file}" }} }}
control = {{ fmu = "gain.py:Controller" }}
[connections]
"boat.tunable.t2" = {{ to = "control.gain", convert = false }}
"""


def test_a_ground_station_tunes_another_component(write, tmp_path: Path) -> None:
    write("gain.py", GAIN)
    file = tmp_path / "boat.param"
    rig = write("rig.toml", RIG.format(tunables="OTHER 1 0 2; STEER_P 9 0 15", file=file))
    for attempt in ("first", "again"):
        system = assemble(load_rig(str(rig)), "direct")
        try:
            master = Master(system)
            master.initialise()
            place = master.names.index(("control", "shown"))
            if attempt == "again":
                assert master.signals[place] == 12.1
                continue
            assert master.signals[place] == 9.0
            (url,) = system.parts["boat"].instance.component.urls
            station = mavutil.mavlink_connection(url.replace("udpin:", "udpout:"))
            deadline = time.monotonic() + 20.0
            station.mav.heartbeat_send(6, 8, 0, 0, 4)
            station.mav.param_set_send(1, 1, b"STEER_P", 12.1, 9)
            while master.signals[place] != 12.1:
                master.step()
                assert time.monotonic() < deadline
                time.sleep(0.0005)
            station.close()
        finally:
            system.free()
    assert file.read_text().split() == ["STEER_P", "12.1"]


def test_a_start_outside_the_limits_of_the_other_component_is_named(write, tmp_path: Path) -> None:
    write("gain.py", GAIN)
    file = tmp_path / "boat.param"
    write("rig.toml", RIG.format(tunables="OTHER 1 0 2; STEER_P 25 0 50", file=file))
    text = str(write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n'))
    with pytest.raises(InputError, match=r"control\.gain is 25\.0 N/m, allowed at most 20"):
        run_trial(load_trial(text), tmp_path / "run", engine="direct")


def test_two_stations_fetch_all_parameters_at_once(write, tmp_path: Path) -> None:
    """pymavlink collects what comes after it requested the list once."""
    write("gain.py", GAIN)
    rig = write("rig.toml", RIG.format(tunables="A 1 0 2; B 1 0 2", file=tmp_path / "x.param"))
    system = assemble(load_rig(str(rig)), "direct")
    stations = []
    try:
        master = Master(system)
        master.initialise()
        component = system.parts["boat"].instance.component
        names = set(component._parameters.names)
        there = component.urls[0].replace("udpin:", "udpout:")
        for number in (250, 255):
            stations.append(mavutil.mavlink_connection(there, source_system=number))
            stations[-1].mav.heartbeat_send(6, 8, 0, 0, 4)
            stations[-1].mav.param_request_list_send(1, 1)
        deadline = time.monotonic() + 20.0
        while any(set(station.params) != names for station in stations):
            master.step()
            for station in stations:
                while station.recv_msg() is not None:
                    pass
            assert time.monotonic() < deadline
            time.sleep(0.0005)
    finally:
        for station in stations:
            station.close()
        system.free()
    assert [station.params["WP_RADIUS"] for station in stations] == [3.0, 3.0]
