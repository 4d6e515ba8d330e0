"""From a user's log to a vehicle file that a rig takes, and to its page."""

import re

import numpy as np
import pytest

from benchmarks.identification import CASES, synthetic
from seatrial.errors import InputError
from seatrial.physics.craft.rov import Rov
from seatrial.system.parameters import load_vehicle
from seatrial_kits.identify.studies.experiment import load_experiment
from seatrial_kits.identify.studies.page import write_page
from seatrial_kits.identify.studies.study import study
from seatrial_kits.identify.studies.vehicle_file import base_vehicle, write_vehicle
from tests.command import seatrial

from .conftest import EXPERIMENT

BASE = (
    EXPERIMENT
    + '\n[result]\nvehicle = "videoray"\nvariant = "source"\nthruster = "horizontal-thruster"\n'
)


def found_in(path):
    return study(load_experiment(str(path)))


def test_parameters_of_the_vehicle(pool):
    """8.44 kg, 0.95 N.s/m, 20 N.s2/m2: within three of the deviations that are stated."""
    found = found_in(pool())
    physical = found.physical()
    truth = {"total mass": 8.44, "added mass": 1.94, "linear": 0.95, "quadratic": 20.0}
    for name, value in truth.items():
        assert abs(physical[name].value - value) < 3.0 * physical[name].deviation, name
    assert physical["total mass"].deviation < 0.05
    assert physical["quadratic"].deviation < 0.5
    assert found.delay == pytest.approx(0.3)
    assert found.accepted
    assert found.whiteness.white


@pytest.mark.interop
def test_held_out_data_is_not_seen(pool, surge):
    clean = found_in(pool())
    spoilt = [*surge["ax"][:420], *surge["ax"][:180]]
    other = found_in(pool({**surge, "ax": spoilt}))
    assert other.estimate.values == clean.estimate.values
    assert other.free_run_fit < 0.5
    assert not other.accepted


@pytest.mark.slow
def test_a_second_log_checks(pool, surge):
    text = EXPERIMENT.replace('log = "pool.csv"', 'log = "pool.csv"\ntest_log = "other.csv"')
    path = pool(text=text)
    log = synthetic(CASES[1], 12).log
    pitch = np.radians(np.array([float(cell) for cell in surge["pitch"]]))
    reading = 100.0 * (log.measured[:600] + 9.81 * np.sin(pitch))
    lines = ["t,beta,ax,roll,pitch"]
    for k, (beta, ax) in enumerate(zip(100 * log.command[:600], reading, strict=True)):
        lines.append(f"{k / 10},{float(beta)!r},{float(ax)!r},0,{surge['pitch'][k]}")
    path.with_name("other.csv").write_text("\n".join(lines))
    found = found_in(path)
    assert len(found.fitted.command) == len(found.test.command) == 600
    assert found.free_run_fit > 0.95
    path.with_name("other.csv").write_text("\n".join([lines[0], *lines[1::2]]))
    with pytest.raises(InputError, match=r"other.csv: rows 0.2 s apart, .* has 0.1 s"):
        found_in(path)


def test_the_vehicle_file_is_the_base_with_a_variant(pool, tmp_path):
    found = found_in(pool(text=BASE))
    path = tmp_path / "vehicle.toml"
    write_vehicle(found, base_vehicle(found), path)
    written, base = load_vehicle(str(path)), load_vehicle("videoray")
    assert written.file.default == "identified"
    assert written.file.components == base.file.components
    assert written.file.presets == base.file.presets
    entries = written.parameter_set("rov", None).values
    assert entries["mass"] == base.file.components["rov"]["mass"]
    assert entries["added_mass.xx"].value == found.physical()["added mass"].value
    assert entries["linear_damping_force.u"].mark == "identified"
    assert re.search(r"from pool.csv, surge: standard deviation [\d.]+", entries["added_mass.xx"].source)  # fmt: skip
    thruster = written.parameter_set("horizontal-thruster", None).values
    assert thruster["delay"].value == pytest.approx(0.3)
    rov = Rov("rov")
    for name, entry in entries.items():
        rov.set(name, entry.value)
    assert rov.added_mass[0] == found.physical()["added mass"].value
    assert rov.added_mass[1] == 6.05


@pytest.mark.long
@pytest.mark.interop
def test_another_axis_is_added_to_an_identified_vehicle(pool, tmp_path):
    first = found_in(pool(text=BASE))
    write_vehicle(first, base_vehicle(first), tmp_path / "vehicle.toml")
    text = BASE.replace('"videoray"\nvariant = "source"', '"vehicle.toml"').replace(
        'axis = "surge"', 'axis = "heave"'
    )
    second = found_in(pool(text=text.replace("[known]", "[known]  # on z")))
    write_vehicle(second, base_vehicle(second), tmp_path / "both.toml")
    names = load_vehicle(str(tmp_path / "both.toml")).parameter_set("rov", None).values
    assert {"added_mass.xx", "added_mass.zz", "quadratic_damping_force.w"} <= set(names)


def test_without_a_vehicle_the_file_has_what_was_identified(pool, tmp_path):
    found = found_in(pool())
    write_vehicle(found, base_vehicle(found), tmp_path / "vehicle.toml")
    file = load_vehicle(str(tmp_path / "vehicle.toml")).file
    assert list(file.components) == ["rov"]
    assert len(file.components["rov"]) == 3


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"videoray"', '"videoary"', "did you mean 'videoray'"),
        ('"horizontal-thruster"', '"horizontal"', "result.thruster: unknown component table"),
        ('variant = "source"', 'variant = "x"', "result.variant: unknown"),
        ('variant = "source"', "", "drivable of .* has surge drag by point-drag, too.*: source$"),
    ],
)
def test_a_base_that_is_not_there(pool, old, new, expected):
    with pytest.raises(InputError, match=expected):
        base_vehicle(found_in(pool(text=BASE.replace(old, new))))


def test_page(pool, tmp_path):
    page = write_page(found_in(pool()), tmp_path, None).read_text("utf-8")
    assert "Surge in the pool" in page
    assert "ACCEPTED" in page
    assert page.count('class="figure"') == 4


@pytest.mark.parametrize(
    ("rows", "held_out", "expected"),
    [(60, 0.3, "18 rows held out"), (60, 0.6, "24 rows to fit")],
)
def test_parts_that_are_too_short(pool, rows, held_out, expected):
    text = EXPERIMENT.replace("axis =", f"held_out = {held_out}\naxis =")
    with pytest.raises(InputError, match=f"{expected}, at least 40 are needed"):
        found_in(pool(text=text, rows=rows))


# ---------------------------------------------------------------------- the command


def identify(*arguments, cwd):
    return seatrial("identify", *arguments, cwd=cwd)


@pytest.mark.slow
def test_the_command(pool, tmp_path):
    pool(text=BASE)
    done = identify("pool.toml", "--out", "out", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("PASS") == 4
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"vehicle.toml", "report.html"}
    again = identify("pool.toml", "--out", "out", cwd=tmp_path)
    assert again.returncode == 2
    assert "not an empty folder" in again.stderr


def test_a_rejected_model_leaves_no_vehicle(pool, tmp_path):
    pool(text=EXPERIMENT.replace('"93.41 N"', '"9.341 N"'))
    done = identify("pool.toml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 1
    assert "FAIL  mass with added mass is plausible: 0.1" in done.stdout
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["report.html"]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["videoray-surg"], "did you mean 'videoray-surge'"),
        (["videoray-surge"], "no log is named; name one with --log"),
        (["videoray-surge", "--log", "nothing"], "there is no log nothing"),
    ],
)
def test_bad_input_leaves_nothing(arguments, expected, tmp_path):
    done = identify(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert expected in done.stderr
    assert not list(tmp_path.iterdir())
