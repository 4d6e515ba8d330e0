"""Damping from dimensions: closed forms, tables of the friction line, and what is printed."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.identify.damping import HullForm, cross_flow, damping, friction_line
from seatrial_kits.identify.hull_file import estimate_damping
from tests.command import seatrial

# ITTC 1957, as its proceedings tabulate it: Re, 1000 C_f.
TABULATED = ((1e6, 4.688), (1e7, 3.000), (1e8, 2.083), (1e9, 1.531))


@pytest.mark.parametrize(("reynolds", "cf"), TABULATED)
def test_friction_line_is_the_tabulated_one(reynolds, cf):
    assert friction_line(reynolds) * 1000.0 == pytest.approx(cf, abs=6e-4)


def box(**changes):
    values = {"length": 2.0, "draught": (0.3,) * 2, "beam": (0.2,) * 2}
    return HullForm(**{**values, "wetted_area": 1.6, "frontal_area": 0.06, **changes})


def by_symbol(hull):
    return {each.symbol: each.value for each in damping(hull, 1.0, 1000.0, 1e-6)}


def test_a_box_has_the_closed_forms():
    found = by_symbol(box(hulls=2, hulls_across=1))
    half = 500.0 * 1.2
    assert found["Y_v|v|"] == pytest.approx(-half * 0.3 * 2.0)
    assert found["N_r|r|"] == pytest.approx(-half * 0.3 * 2.0**4 / 32.0)
    assert found["Z_w|w|"] == pytest.approx(-2 * half * 0.2 * 2.0)
    assert found["M_q|q|"] == pytest.approx(-2 * half * 0.2 * 2.0**4 / 32.0)
    assert found["X_u|u|"] == pytest.approx(-500.0 * 0.06 * 0.45)
    assert {found[name] for name in ("N_v|v|", "Y_r|r|", "M_w|w|", "Z_q|q|")} == {0.0}


def test_signs_are_those_of_forces_on_a_hull_that_lies_aft():
    # All of it aft of the origin: sway pushes the stern, which turns the bow towards the motion.
    found = by_symbol(box(middle=-3.0))
    assert found["N_v|v|"] > 0.0 > found["M_w|w|"]
    assert found["Y_r|r|"] > 0.0 > found["Z_q|q|"]


@pytest.mark.parametrize("middle", [-2.0, -0.3, 0.0, 0.4])
def test_strips_of_any_draught_summed_by_hand(middle):
    draught = (0.0, 0.25, 0.3, 0.1)
    found = cross_flow(box(middle=middle), draught, 1.1, 1025.0)
    x = middle - 1.0 + (np.arange(200_000) + 0.5) * 1e-5
    width = np.interp(x, middle + np.linspace(-1.0, 1.0, 4), draught) * 0.5 * 1025.0 * 1.1 * 1e-5
    powers = (np.ones_like(x), x, x * abs(x), abs(x) ** 3)
    expected = [float(np.sum(width * power)) for power in powers]
    given = [found.force, found.lever, found.by_turning, found.moment]
    assert given == pytest.approx(expected, abs=1e-6)


def test_the_otter_has_the_constant_of_its_source():
    # MSS otter.m: 1/2 rho T C_d = 100.42099954 kg/m2, the same strips over 2 m.
    found = by_symbol(
        box(draught=(0.195121951219512,) * 2, drag_across=1.0042099954 * 1.025, hulls=2)
    )
    assert found["Y_v|v|"] == pytest.approx(-2.0 * 100.42099954, rel=1e-9)


def test_a_short_slow_hull_has_no_friction_line():
    with pytest.raises(InputError, match="Reynolds number is 20"):
        damping(box(), 1e-5, 1000.0, 1e-6)


def test_the_hydrone_on_the_command_line(tmp_path):
    done = seatrial("estimate", "hydrone", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "quadratic_damping_force = { value = [4.235, 67.33, 335.9]" in done.stdout
    assert estimate_damping("hydrone").of("X_u") == pytest.approx(-2.08, abs=5e-3)


HULL = 'length = "2 m"\ndraught = "0.3 m"\nbeam = "0.2 m"\nspeed = "1 m/s"\n'


def test_sections_from_stern_to_bow(tmp_path):
    path = tmp_path / "hull.toml"
    path.write_text(HULL.replace('"0.3 m"', '["0 m", "30 cm", 0.3, "0 m"]'))
    found = estimate_damping(str(path)).hull
    assert found.draught == (0.0, 0.3, 0.3, 0.0)
    assert found.frontal_area == pytest.approx(0.06)
    assert found.wetted_area == pytest.approx(2.0 * (0.2 + 2.0 * 0.2), rel=1e-5)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('length = "0 m"', "length: above 0 is needed, found '0 m'"),
        ('draught = "0 m"', "draught: 0 m and more are needed"),
        ('draught = ["1 m"]', "draught: one value, or two and more"),
        ('speed = "1 kg"', "speed: "),
        ('speed = "1 um/s"', "the Reynolds number is 1.68"),
        ("hulls = 0", "hulls"),
        ("drought = 1", "drought"),
    ],
)
def test_what_cannot_be_is_named(tmp_path, line, said):
    path = tmp_path / "hull.toml"
    key = line.partition(" ")[0]
    kept = [each for each in HULL.splitlines() if not each.startswith(f"{key} ")]
    path.write_text("\n".join([*kept, line]))
    with pytest.raises(InputError, match=r"hull\.toml") as caught:
        estimate_damping(str(path))
    assert said in str(caught.value)
