"""Sea, current and wind of a trial: one for all components, by file and command line, and errors."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.sea.seastate import SeaState
from seatrial.physics.sea.spectra import Jonswap
from seatrial.system.packages import read_package
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.sea_section import sea_figures
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.preparation import prepare
from seatrial.trial.running.run import run_trial
from seatrial_kits.interchange.export import export_ssp
from tests.kit import needs_kits

pytestmark = needs_kits("ships", "videoray")
RIG = """
step = "20 ms"
[components]
ship = { fmu = "thruster-ship", parameters = "thruster-ship" }
boat = { fmu = "marine-craft", parameters = "hydrone" }
rov  = { fmu = "rov", parameters = "videoray" }
"""
TRIAL = 'rig = "rig.toml"\nstop = "0.2 s"\nseed = 7\n'
SEA = 'sea = { spectrum = "jonswap", height = "0.5 m", period = "4 s", direction = "30 deg" }\n'


@pytest.fixture
def trial(tmp_path):
    """Return what loads a trial of the rig with more lines and changes."""
    (tmp_path / "rig.toml").write_text(RIG)

    def load(text="", rig=RIG, **changes):
        (tmp_path / "rig.toml").write_text(rig)
        path = tmp_path / "trial.toml"
        path.write_text(TRIAL + text)
        return load_trial(str(path), changes=changes, origin="--set")

    return load


def parameters(trial, tmp_path):
    """Run a trial; return the parameters of its components."""
    done = run_trial(trial, out=tmp_path / "run", engine="direct")
    manifest = load_run(done.folder).manifest
    return {
        name: {key: value["value"] for key, value in component["parameters"].items()}
        for name, component in manifest["components"].items()
    }


def of_group(found, group):
    return {
        name: {key: value for key, value in given.items() if key.startswith(f"{group}_")}
        for name, given in found.items()
    }


@pytest.mark.slow
def test_all_components_meet_the_same_sea(trial, tmp_path):
    text = SEA + '[current]\nspeed = "1 kn"\n[wind]\nspeed = "10 m/s"\nspectrum = "norsok"\n'
    found = parameters(trial(text), tmp_path)
    for group, key, value in (
        ("sea", "sea_height", 0.5),
        ("current", "current_speed", 1852 / 3600),
        ("wind", "wind_speed", 10.0),
    ):
        each = of_group(found, group)
        assert each["ship"] == each["boat"]
        assert group == "wind" or each["rov"] == each["boat"]
        assert each["ship"][key] == pytest.approx(value)
    assert found["boat"]["sea_direction"] == pytest.approx(np.radians(30))
    assert found["boat"]["sea_seed"] == found["boat"]["wind_seed"] == 7
    assert found["boat"]["sea_spectrum"] == "jonswap"


@pytest.mark.slow
def test_the_command_line_changes_one_key_of_the_file(trial, tmp_path):
    found = parameters(trial(SEA, **{"sea.height": "1 m", "wind.speed": 5}), tmp_path)
    assert found["rov"]["sea_height"] == 1.0
    assert found["rov"]["sea_period"] == 4.0
    assert found["ship"]["wind_speed"] == 5.0


@pytest.mark.slow
@pytest.mark.parametrize(("degree", "height"), [(1, 0.05), (3, 0.875), (9, 14.0)])
def test_a_degree_of_the_sea_is_a_fully_developed_one(trial, tmp_path, degree, height):
    found = parameters(trial(f"sea = {{ douglas = {degree} }}\n"), tmp_path)["ship"]
    assert found["sea_height"] == height
    assert found["sea_spectrum"] == "pierson-moskowitz"


def test_degree_0_is_calm(trial, tmp_path):
    assert parameters(trial("sea = { douglas = 0 }\n"), tmp_path)["ship"]["sea_spectrum"] == "none"


def test_layers_of_a_current(trial, tmp_path):
    layers = "".join(
        f'[[current.layers]]\ndepth = "{z} m"\nspeed = {z / 10}\ndirection = "{40 * z} deg"\n'
        for z in (0, 5, 10)
    )
    found = parameters(trial(layers), tmp_path)["rov"]
    assert found["current_profile"] == "layers"
    assert found["current_layers"] == 3
    assert found["current_layer_depths.l3"] == 10.0
    assert found["current_layer_directions.l2"] == pytest.approx(np.radians(200))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("sea = { hight = 1 }", r"trial.toml: sea.hight: .*did you mean 'height'"),
        ('sea = { height = "1 kg", period = 4 }', r"sea\.height: .*sea_height: .*kg"),
        ('sea = { spectrum = "jonswop", height = 1, period = 4 }', "jonswop.*jonswap"),
        ("sea = { period = 4 }", "a sea needs its height"),
        ("sea = { height = 1, douglas = 3 }", "douglas and height both"),
        ("sea = { douglas = 10 }", r"sea\.douglas: .*9, found 10"),
        ("sea = { height = -1, period = 4 }", r"sea_height: .*-1"),
        ('sea = { spectrum = "jonswap", height = 1 }', r"trial.toml: sea: sea: period is 0"),
        ('current = { profile = "power", speed = 1 }', "reach is 0.0 m"),
        ("current = { layers = [ { depth = 0, speed = 1, direction = 0 } ] }", "layers"),
        ('wind = { spectrum = "norsok" }', "speed is 0.0: give it"),
        ("wind = { speed = true }", r"wind\.speed"),
    ],
)
def test_what_cannot_be_is_refused(trial, tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        run_trial(trial(text), out=tmp_path / "run", engine="direct")
    assert not (tmp_path / "run").exists()


def test_a_rig_that_meets_no_waves_says_so(trial, tmp_path):
    rig = 'step = "20 ms"\n[components]\nwind = { fmu = "wind" }\n'
    with pytest.raises(InputError, match="no component of the rig meets waves"):
        run_trial(trial(SEA, rig), out=tmp_path / "run", engine="direct")


def test_a_component_of_that_name_is_meant_by_the_command_line(trial):
    rig = 'step = "20 ms"\n[components]\nwind = { fmu = "wind" }\n'
    assert trial("", rig, **{"wind.mean_speed": 3}).overrides[0][0] == "wind.mean_speed"


def test_the_wind_of_a_trial_takes_the_place_of_the_components_own(trial, tmp_path):
    rig = 'step = "20 ms"\n[components]\nair = { fmu = "wind" }\n'
    text = 'wind = { speed = 8, direction = "90 deg", profile = "power" }\n'
    run = run_trial(trial(text + '[set]\n"air.height" = 5\n', rig), tmp_path / "run")
    east = load_run(run.folder).signals["air.velocity.east"]
    np.testing.assert_allclose(east, 8 * 0.5**0.12)


@pytest.mark.slow
def test_the_report_shows_what_was_met_and_nothing_in_calm(trial, tmp_path):
    calm = run_trial(trial(), out=tmp_path / "calm", engine="direct")
    assert list(sea_figures(load_run(calm.folder))) == []
    text = SEA + "current = { speed = 1 }\nwind = { speed = 9 }\n"
    run = load_run(run_trial(trial(text), out=tmp_path / "rough", engine="direct").folder)
    (_, over_time), (title, spectrum) = sea_figures(run)
    assert title.startswith("Spectrum of the waves: jonswap, Hs 0.5 m, Tp 4 s, Tz 3.13 s")
    traces = {trace["name"]: trace for trace in over_time.data}
    waves = SeaState("jonswap", 0.5, 4.0, np.radians(30), seed=7).waves()
    place = [run.signals[f"boat.position.{axis}"] for axis in "xy"]
    np.testing.assert_allclose(
        traces["boat"]["y"],
        [waves.elevation(t, at) for t, at in zip(run.time, np.stack(place, 1), strict=True)],
        atol=1e-12,
    )
    assert set(traces["speed"]["y"]) == {9.0}
    assert spectrum.data[0]["y"].max() == pytest.approx(
        float(Jonswap(0.5, 4.0).density(np.array([np.pi / 2]))[0]), rel=0.02
    )


@pytest.mark.slow
def test_a_package_for_other_tools_has_the_same_sea(trial, tmp_path):
    trial(SEA + "current = { speed = 0.5 }\n")
    path = tmp_path / "trial.toml"
    package, _notes = export_ssp(str(path), tmp_path / "sea.ssp")
    content = read_package(package, {})
    given = content.rig.components["boat"].entry.set
    assert given["sea_height"] == 0.5
    assert given["sea_spectrum"] == "jonswap"
    assert given["current_speed"] == 0.5


DRIFTER = """
from seatrial.model.component import Component, Input


class Drifter(Component):
    current = Input("m/s", "velocity of the water", axes=("north", "east", "down"))
"""


def test_what_a_current_does_not_reach_is_noted(trial, tmp_path):
    (tmp_path / "drifter.py").write_text(DRIFTER)
    rig = RIG + 'drifter = { fmu = "drifter.py:Drifter" }\n'

    def noted(text):
        system = prepare(trial(text, rig=rig), "direct", Hooks()).system
        system.free()
        return [note.partition(": ")[2] for note in system.notes if "does not reach" in note]

    assert noted('[current]\nspeed = "1 kn"\n') == [
        "current: it does not reach drifter.current: set or connect it"
    ]
    assert noted(SEA) == []


@pytest.mark.slow
def test_swells_are_a_list(trial, tmp_path):
    swell = 'swell = [{ height = "40 cm", period = "12 s", direction = "90 deg" }]'
    loaded = trial(SEA.replace(" }", f", {swell} }}"))
    ship = parameters(loaded, tmp_path)["ship"]
    assert [ship[f"sea_swell_height.s{k}"] for k in (1, 2, 3)] == [0.4, 0.0, 0.0]
    assert ship["sea_swell_direction.s1"] == pytest.approx(np.pi / 2)
    assert ship["sea_swell_gamma.s1"] == 7.0
    titles = [title for title, _ in sea_figures(load_run(tmp_path / "run"))]
    assert any(
        "jonswap and a swell, Hs 0.64" in title for title in titles
    )  # of both: sqrt(0.5^2 + 0.4^2)


@pytest.mark.slow
def test_a_swell_may_be_alone(trial, tmp_path):
    loaded = trial('[[sea.swell]]\nheight = "1 m"\nperiod = "12 s"\n')
    ship = parameters(loaded, tmp_path)["ship"]
    assert (ship["sea_spectrum"], ship["sea_swell_height.s1"]) == ("none", 1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[sea.swell]]\nheight = "3 m"\nperiod = "3 s"\n', r"swell 1: height 3 m at a period of"),
        ('[[sea.swell]]\nheight = "3 m"\n', r"sea\.swell\.0\.period|sea\.swell.*period"),
        ("[sea]\nswell = []\n", r"sea\.swell"),
    ],
)
def test_what_is_wrong_with_a_swell(trial, text, message):
    with pytest.raises(InputError, match=message):
        prepare(trial(text), "direct", Hooks())
