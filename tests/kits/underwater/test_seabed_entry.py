"""The seabed of a trial reaches all that is over it."""

import re

import pytest

from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.preparation import prepare

RIG = """
step = "10 ms"
[components]
sounder = { fmu = "echo-sounder" }
dvl = { fmu = "dvl" }
hull = { fmu = "marine-craft" }
"""
TRIAL = 'rig = "r.toml"\nstop = "1 s"\n'


def given(folder, text, rig=RIG, **changes):
    """Return what a trial gives its components, by component and port."""
    (folder / "r.toml").write_text(rig, "utf-8")
    (folder / "t.toml").write_text(TRIAL + text, "utf-8")
    trial = load_trial(str(folder / "t.toml"))
    if changes:
        trial = trial.changed({key.replace("_", "."): v for key, v in changes.items()}, "--set")
    system = prepare(trial, "direct", Hooks()).system
    try:
        return {
            (name, port): value.value
            for name, part in system.parts.items()
            for port, value in part.given.items()
        }
    finally:
        system.free()


def test_it_reaches_all_that_is_over_it(tmp_path):
    found = given(
        tmp_path,
        'seabed = { depth = "800 cm", slope = "3 deg", obstacles = "sphere 9 0 4 1" }\n',
    )
    for name in ("sounder", "dvl"):
        assert found[name, "seabed_depth"] == pytest.approx(8.0)
        assert found[name, "seabed_slope"] == pytest.approx(0.0523598775598)
        assert found[name, "obstacles"] == "sphere 9 0 4 1"
    assert ("hull", "seabed_depth") not in found


def test_a_file_is_beside_the_trial(tmp_path):
    (tmp_path / "bed.csv").write_text("north,east,depth\n0,0,5\n0,9,5\n9,0,5\n9,9,5\n", "ascii")
    found = given(tmp_path, 'seabed = { file = "bed.csv" }\n')
    assert found["dvl", "seabed_file"] == str(tmp_path / "bed.csv")


def test_the_command_line_changes_a_key(tmp_path):
    found = given(tmp_path, 'seabed = { depth = "8 m" }\n', seabed_depth="5 m")
    assert found["dvl", "seabed_depth"] == 5.0


SEA = 'sea = { spectrum = "jonswap", height = "0.2 m", period = "3 s"%s }\n'


@pytest.mark.parametrize(
    ("bed", "depth", "wanted"),
    [
        ('depth = "8 m"', "", 8.0),
        ('depth = "8 m"', ', depth = "800 cm"', 8.0),
        ('depth = "8 m", slope = "1 deg"', "", None),
        ('depth = "8 m", slope = "1 deg"', ', depth = "6 m"', 6.0),
    ],
)
def test_the_waves_are_over_the_same_bottom(tmp_path, bed, depth, wanted):
    found = given(tmp_path, f"seabed = {{ {bed} }}\n" + SEA % depth)
    assert found.get(("hull", "sea_depth")) == wanted


@pytest.mark.parametrize(
    ("text", "rig", "message"),
    [
        ('seabed = { depth = "8 m" }\n' + SEA % ', depth = "6 m"', RIG, "one is enough"),
        ('seabed = { depht = "8 m" }\n', RIG, "unknown key 'depht'"),
        ('seabed = { depth = "-8 m" }\n', RIG, "seabed.depth"),
        (
            'seabed = { depth = "8 m" }\n',
            'step = "10 ms"\n[components]\nhull = { fmu = "marine-craft" }\n',
            "no component of the rig looks at the seabed",
        ),
    ],
)
def test_mistakes(tmp_path, text, rig, message):
    with pytest.raises(InputError, match=re.escape(message)):
        given(tmp_path, text, rig)
