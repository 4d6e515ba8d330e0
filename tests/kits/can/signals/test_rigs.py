"""Actuators on a bus: shipped rigs, and their logs as cantools and canmatrix decode them."""

import csv
import re
import subprocess
import sys

import can
import canmatrix.formats
import pytest

from seatrial.errors import InputError
from seatrial.shipped import shipped_folder
from seatrial.system.profile.profile import check_profile, load_profile
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

pytestmark = pytest.mark.interop

PROFILES = shipped_folder("hil_profiles")


@pytest.mark.long
def test_thrusters_on_a_bus(tmp_path):
    """The trial holds; each frame of the log is what the ports had, to half a step of scaling."""
    result = run_trial(load_trial("hydrone-can"), tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []
    assert "hydrone.dbc" in (result.folder / "manifest.json").read_text("utf-8")
    assert str(PROFILES) not in (result.folder / "manifest.json").read_text("utf-8")

    with (result.folder / "signals.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    received = [
        float(row["autopilot.port_node.received.s1"])
        for row in rows
        if row["autopilot.port_node.valid.s1"] == "1"
    ]
    matrix = canmatrix.formats.loadp_flat(str(PROFILES / "hydrone.dbc"))
    command = matrix.frame_by_name("ThrusterCommand")
    with can.LogReader(str(result.folder / "autopilot.can.log")) as log:
        sent = [
            float(command.decode(bytes(each.data))["PortPulse"].phys_value)
            for each in log
            if each.arbitration_id == 0x100
        ]
    assert sorted({round(pulse * 1e6, 1) for pulse in received}) == sorted(
        set(sent[: len(received)])
    )

    # The command line tool reads the log as candump's.
    with (result.folder / "autopilot.can.log").open(encoding="utf-8") as log:
        head = "".join(next(log) for _ in range(30))
    decoded = subprocess.run(
        [sys.executable, "-m", "cantools", "decode", str(PROFILES / "hydrone.dbc")],
        input=head,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert re.findall(r"PortPulse: ([\d.]+) us", decoded)[0] == str(sent[0])
    assert "StarboardCurrent" in decoded


@pytest.mark.long
def test_servos_on_a_disturbed_bus(tmp_path):
    result = run_trial(load_trial("gloria-can"), tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []


@pytest.fixture
def profiles(tmp_path):
    """Return a folder that lies as the shipped profiles do, beside the harness."""
    (tmp_path / "harness").symlink_to(PROFILES.parent / "harness")
    (tmp_path / "profiles").mkdir()
    return tmp_path / "profiles"


def test_a_profile_names_the_file_beside_it(profiles):
    text = (PROFILES / "hydrone.toml").read_text("utf-8")
    (profiles / "boat.toml").write_text(text, "utf-8")
    with pytest.raises(InputError) as caught:
        check_profile(profiles / "boat.toml")
    for part in ("boat.toml", "links.port_node.database", str(profiles / "hydrone.dbc")):
        assert part in str(caught.value)
    (profiles / "hydrone.dbc").write_bytes((PROFILES / "hydrone.dbc").read_bytes())
    found = load_profile(profiles / "boat.toml").parameters("links.port_node")
    assert found["database"] == str(profiles / "hydrone.dbc")


@pytest.mark.parametrize(
    ("change", "dbc", "expected"),
    [
        (("ThrusterCommand.PortPulse 1100", "ThrusterCommand.PortPuls 1100"), ("", ""), "did you mean 'PortPulse'"),
        (("PortPulse 1100 1900 us", "PortPulse 1100 7000 us"), ("", ""), "carries 0 to 2500 us"),
        (("", ""), ("BO_ 386 ", "BO_ 385 "), "PortStatus and StarboardStatus"),
    ],
)  # fmt: skip
def test_a_profile_with_a_mistake_is_refused_with_file_and_key(profiles, change, dbc, expected):
    text = (PROFILES / "hydrone.toml").read_text("utf-8")
    (profiles / "boat.toml").write_text(text.replace(*change, 1), "utf-8")
    text = (PROFILES / "hydrone.dbc").read_text("utf-8")
    (profiles / "hydrone.dbc").write_text(text.replace(*dbc), "utf-8")
    with pytest.raises(InputError) as caught:
        check_profile(profiles / "boat.toml")
    assert expected in str(caught.value)
    key = "sends" if change[0] else "database"
    assert f"boat.toml: links.autopilot_node: {key}: " in str(caught.value)
