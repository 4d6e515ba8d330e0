"""Files that say what of a log is played: in rigs, in both carriers, and refused."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.fmi.components.table import table_component
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.logs.played import played

LOG = "time,rudder [deg],heading [deg],mode\n" + "".join(
    f"{k},{10 * math.sin(k):.6f},{(350 + 5 * k) % 360},{k // 4}\n" for k in range(12)
)


@pytest.fixture
def play(write, tmp_path):
    """Return a function that plays a log and returns what the component has at a time."""

    def make(text, log=LOG, name="boat.csv"):
        write(name, log)
        component = table_component(played(write("boat.toml", text)))("boat")
        component.set("beyond", "hold")
        component.setup(0.0)
        component.initialise()
        component.begin()

        def at(t):
            component.advance(t - 0.5, 0.5)
            return {port: component.get(port) for port in component.ports if port != "beyond"}

        return at

    return make


def test_channels_with_units_and_states(play):
    at = play('log = "boat.csv"\n[play]\nrudder = "-rudder"\npsi = "heading"\nmode = "mode"\n')
    found = at(4.5)
    middle = (10 * math.sin(4) + 10 * math.sin(5)) / 2
    assert found["rudder"] == pytest.approx(-middle, abs=1e-5)
    assert found["psi"] == pytest.approx(372.5)  # over north without a jump
    assert (found["mode"], found["mode_valid"]) == (1.0, True)


def test_a_window_at_another_speed_with_a_delay(play):
    text = 'log = "boat.csv"\nfrom = "2 s"\nto = "8 s"\nspeed = 2.0\nat = "1 s"\n[play]\n'
    at = play(text + 'psi = { channel = "heading", delay = "0.5 s" }\n')
    # At 2 s of the run the log's clock is at 4 s, and the compass was late by 0.5 s.
    assert at(2.0)["psi"] == pytest.approx(350 + 5 * 4.5)
    assert at(9.0)["psi"] == pytest.approx(350 + 5 * 8.5)


def test_in_a_gap_the_last_value_stands_and_is_not_known(play):
    log = "time,x\n0,0.5\n1,1.5\n2,2.5\n20,20.5\n21,21.5\n"
    at = play('log = "boat.csv"\n[play]\nx = "x:m"\n', log)
    assert at(1.5) == {"x": 2.0, "x_valid": True}
    assert at(10.0) == {"x": pytest.approx(2.5, abs=1e-6), "x_valid": False}
    assert at(20.5) == {"x": 21.0, "x_valid": True}
    at = play('log = "boat.csv"\n[play]\nx = { channel = "x", unit = "m", gap = "30 s" }\n', log)
    assert at(11.0) == {"x": 11.5, "x_valid": True}


@given(
    times=st.lists(st.integers(1, 50), min_size=2, max_size=12),
    values=st.lists(st.floats(-100.0, 100.0), min_size=13, max_size=13),
)
def test_the_same_as_numpy_between_the_entries(tmp_path_factory, times, values):
    folder = tmp_path_factory.mktemp("play")
    at = np.cumsum([0, *times]) / 10.0
    lines = [f"{t!r},{v!r}" for t, v in zip(at.tolist(), values, strict=False)]
    (folder / "boat.csv").write_text("time,x\n" + "\n".join(lines) + "\n")
    (folder / "boat.toml").write_text(
        'log = "boat.csv"\n[play]\nx = { channel = "x", held = false, gap = "1000 s" }\n'
    )
    content = json.loads(played(folder / "boat.toml"))
    assert content["times_ns"] == [round(t * 1e9) for t in at.tolist()]
    assert content["columns"][0][4] == pytest.approx(values[: len(at)])


@pytest.mark.parametrize("engine", ["direct", pytest.param("fmu", marks=pytest.mark.slow)])
def test_in_a_rig_again_and_again(write, tmp_path, engine):
    write("boat.csv", "time,x [m]\n0,0.5\n1,1.5\n2,0.5\n")
    write("boat.toml", 'log = "boat.csv"\n[play]\nx = "x"\n')
    write("rig.toml", 'step = "250 ms"\n[components]\n'
          'boat = { fmu = "boat.toml", set = { beyond = "repeat" } }\n')  # fmt: skip
    write("trial.toml", 'rig = "rig.toml"\nstop = "6 s"\n')
    result = run_trial(load_trial(str(tmp_path / "trial.toml")), tmp_path / "run", engine=engine)
    assert result.status == "complete"
    run = load_run(result.folder)
    expected = 0.5 + np.abs((run.time + 1.0) % 2.0 - 1.0)
    np.testing.assert_allclose(run.signals["boat.x"], expected, atol=1e-6)
    assert run.units["boat.x"] == "m"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('log = "boat.csv"\n', r"keys log and \[play\]; found log"),
        ('log = "boat.csv"\n[play]\nx = "rudr"\n', "play.x: .*did you mean 'rudder'"),
        ('log = "boat.csv"\n[play]\nx = "rudder:m"\n', "play.x: .*deg, not m"),
        ('log = "boat.csv"\n[play]\nstep = "rudder"\n', "play.step: an output cannot be called"),
        ('log = "boat.csv"\nspeed = 0.0\n[play]\nx = "rudder"\n', "speed"),
        ('log = "boat.csv"\nfrom = "3 m"\n[play]\nx = "rudder"\n', "from: "),
        ('log = "boat.csv"\nfrom = "30 s"\n[play]\nx = "rudder"\n', "from is 30 s, after the end"),
        ('log = "boot.csv"\n[play]\nx = "rudder"\n', "there is no log"),
        ('log = "boat.csv"\n[play]\nx = "heading"\nx_valid = "mode"\n', "x_valid"),
    ],
)
def test_refused_with_file_and_key(play, text, said):
    with pytest.raises(InputError, match=said):
        play(text)


def test_too_much_to_be_played_is_refused(tmp_path):
    count = 2_000_000
    table = np.column_stack((np.arange(count), np.arange(count) % 7))
    with (tmp_path / "boat.csv").open("w") as file:
        file.write("time,x\n")
        np.savetxt(file, table, fmt="%d", delimiter=",")
    (tmp_path / "boat.toml").write_text('log = "boat.csv"\n[play]\nx = "x:m"\ny = "-x:m"\n')
    with pytest.raises(InputError, match="2000000 rows of 2 outputs are too many"):
        played(tmp_path / "boat.toml")


test_too_much_to_be_played_is_refused = pytest.mark.slow(test_too_much_to_be_played_is_refused)
