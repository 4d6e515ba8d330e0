"""The message of a simulation that diverges names what was last changed from outside."""

import time
from pathlib import Path

import pytest
from pymavlink import mavutil

from seatrial import Simulation
from seatrial.errors import SimulationError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from tests.kit import needs_kits

pytestmark = needs_kits("mavlink")

GROWING = '''
from seatrial.model.component import Component, Input, Output, Parameter


class Growing(Component):
    """x(k + 1) = (1 + gain) x(k) + u, from 1."""

    gain = Parameter(0.0, "1", "growth in a step", max=1e9, tunable=True)
    u = Input("1", "what is added")
    x = Output("1", "state", start=1.0)

    def start(self, t):
        self._x = 1.0

    def step(self, t, h):
        self._x = (1.0 + self.gain) * self._x + self.u

    def outputs(self, t):
        self.x = self._x
'''
RIG = """
step = "100 ms"
[components]
a = { fmu = "growing.py:Growing" }
b = { fmu = "growing.py:Growing" }
link = { fmu = "mavlink", set = { links = "udpin:127.0.0.1:0", tunables = "GROWTH 0 0 1e6" } }
[connections]
"a.x" = "b.u"
"link.tunable.t1" = "b.gain"
"""
LAST = "last changed from outside: "


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    (tmp_path / "growing.py").write_text(GROWING)
    (tmp_path / "rig.toml").write_text(RIG)
    return tmp_path / "rig.toml"


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_an_event_is_named(rig: Path, tmp_path: Path, engine: str) -> None:
    path = tmp_path / "trial.toml"
    path.write_text(
        'rig = "rig.toml"\nstop = "60 s"\n[[events]]\nat = "1 s"\nset = { "a.gain" = 1e6 }\n'
    )
    result = run_trial(load_trial(str(path)), out=tmp_path / "run", engine=engine)
    assert result.status == "failed"
    assert "beyond any quantity" in result.error
    assert f"{LAST}a.gain set to 1000000.0, at t = 1.0 s" in result.error


def test_what_a_program_sets_and_the_later_of_two_is_named(rig: Path) -> None:
    with Simulation(rig) as sim:
        sim.set("a.u", 1.0)
        sim.step(3)
        sim.set("a.gain", 1e8)
        with pytest.raises(SimulationError, match=rf"{LAST}a.gain set to .*, at t = 0.3"):
            sim.step(100)


def test_a_fault_is_named(rig: Path) -> None:
    with Simulation(rig) as sim:
        sim.step(2)
        sim.set("a.u", 0.0)
        sim.override("b.u", 9e307)  # twice that is no number
        with pytest.raises(SimulationError, match=rf"{LAST}override of b.u, .*9e\+307.*t = 0.2"):
            sim.step(10)


def test_nothing_is_named_where_nothing_was_changed(rig: Path) -> None:
    with Simulation(rig, set={"a.gain": 1e8}) as sim, pytest.raises(SimulationError) as caught:
        sim.step(100)
    assert LAST not in str(caught.value)


def test_where_a_run_leaves_its_files_is_no_change(rig: Path, tmp_path: Path) -> None:
    path = tmp_path / "trial.toml"
    path.write_text('rig = "rig.toml"\nstop = "60 s"\n[set]\n"a.gain" = 1e6\n')
    result = run_trial(load_trial(str(path)), out=tmp_path / "run", engine="direct")
    assert result.status == "failed"
    assert LAST not in result.error


def test_an_order_over_a_link_is_named(rig: Path) -> None:
    with Simulation(rig) as sim:
        station = mavutil.mavlink_connection(
            "udpout:" + sim.get("link.reached_at").split(":", 1)[1]
        )
        station.mav.heartbeat_send(6, 8, 0, 0, 4)
        station.mav.param_set_send(1, 1, b"GROWTH", 5e5, 9)
        deadline = time.monotonic() + 30.0
        with pytest.raises(SimulationError) as caught:
            while time.monotonic() < deadline:
                sim.step()
                time.sleep(0.002)
        station.close()
    assert f"{LAST}link was ordered PARAM_SET GROWTH 500000, at t = " in str(caught.value)
