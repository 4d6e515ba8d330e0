"""Sections, hydrostatics and windage from a shape, beside closed forms; runs in the weather."""

import math

import numpy as np
import pytest

from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.shape import ShapePart
from seatrial.system.silhouette import silhouettes

HEAD = """
title = "a boat"
source = "invented"
[marine-craft]
mass = { value = 80, unit = "kg", source = "invented", mark = "assumed" }
density = { value = 1000, unit = "kg/m3", source = "invented", mark = "assumed" }
center_of_gravity = { value = [0, 0, -0.1], unit = "m", source = "invented", mark = "assumed" }
"""
PLANE = """
waterplane_area = { value = 0.8, unit = "m2", source = "invented", mark = "assumed" }
"""
SECTIONS = "length = 2.0, beam = [0.3, 0.3], draught = [0.1, 0.1], freeboard = 0.2"
ONE = f"[shape]\nmarine-craft = [ {{ hull = {{ {SECTIONS} }}, at = [0.1, 0, 0.05] }} ]\n"
TWO = f"""[shape]
marine-craft = [
  {{ hull = {{ {SECTIONS} }}, at = [0.1, -0.5, 0] }},
  {{ hull = {{ {SECTIONS} }}, at = [0.1, 0.5, 0] }},
]
"""
THREE = f"""[shape]
marine-craft = [
  {{ hull = {{ {SECTIONS} }}, at = [0.1, 0, 0] }},
  {{ hull = {{ length = 1, beam = [0.1, 0.1], draught = [0.05, 0.05], freeboard = 0.1 }}, at = [0, -0.8, 0] }},
  {{ hull = {{ length = 1, beam = [0.1, 0.1], draught = [0.05, 0.05], freeboard = 0.1 }}, at = [0, 0.8, 0] }},
]
"""


@pytest.fixture
def given(tmp_path):
    """Return what a hull is given by a vehicle's file, by variable."""

    def read(text):
        (tmp_path / "boat.toml").write_text(text)
        rig = tmp_path / "rig.toml"
        rig.write_text(
            'step = "10 ms"\n[components]\n'
            'hull = { fmu = "marine-craft", parameters = "boat.toml" }\n'
        )
        system = assemble(load_rig(str(rig)), engine="direct")
        try:
            return dict(system.parts["hull"].given)
        finally:
            system.free()

    return read


def values(given, name, count=11):
    return np.array([given[f"{name}.s{i}"].value for i in range(count)])


def test_sections_have_the_waterplane_and_the_displacement_of_the_vehicle(given):
    found = given(HEAD + PLANE + TWO)
    dx = found["hull_length"].value / 10
    assert found["hull_spacing"].value == 1.0
    assert 2 * np.trapezoid(values(found, "section_beam"), dx=dx) == pytest.approx(0.8)
    area = values(found, "section_area")
    assert 2 * np.trapezoid(area, dx=dx) == pytest.approx(80 / 1000)
    ellipse = math.pi / 4 * values(found, "section_beam") * values(found, "section_draught")
    np.testing.assert_allclose(area, ellipse, rtol=1e-12)
    assert found["section_beam.s0"].mark == "assumed"
    assert "scaled to waterplane and displacement" in found["section_beam.s0"].source
    assert found["terms"].value.split()[-2:] == ["wave-loads", "wind-loads"]


def test_metacentric_heights_are_those_of_the_sections(given):
    found = given(HEAD + ONE)
    volume, plane = 0.08, 0.6
    draught = volume / (math.pi / 4 * plane)
    z_B = 0.05 + 4 * draught / (3 * math.pi)
    assert found["waterplane_area"].value == pytest.approx(plane)
    across = 2.0 * 0.3**3 / 12 / volume
    assert found["GM_T"].value == pytest.approx(across - (z_B + 0.1), rel=1e-12)
    # The trapezoidal rule over 10 steps has 1 % more than b L^3 / 12.
    along = 0.3 * 2.0**3 / 12 / volume
    assert found["GM_L"].value == pytest.approx(along - (z_B + 0.1), rel=0.03)
    assert found["hull_waterline"].value == -0.05
    assert found["hull_middle"].value == 0.1


def test_side_hulls_are_a_pair_of_their_own(given):
    found = given(HEAD + THREE)
    assert found["hull_spacing"].value == 0.0
    assert found["side_spacing"].value == 1.6
    assert found["side_length"].value == 1.0
    across = (2.0 * 0.3**3 + 2 * 0.1**3) / 12 + 2 * 0.1 * 0.8**2
    draught = values(found, "section_draught")[0]
    assert values(found, "side_draught")[0] == pytest.approx(0.5 * draught)
    below = sum(
        area * length * 4 * depth / (3 * math.pi)
        for area, length, depth in (
            (math.pi / 4 * 0.3 * draught, 2.0, draught),
            (2 * math.pi / 4 * 0.1 * draught / 2, 1.0, draught / 2),
        )
    )
    assert found["GM_T"].value == pytest.approx(across / 0.08 - (below / 0.08 + 0.1), rel=1e-9)


def test_what_the_file_gives_stays(given):
    own = 'GM_T = { value = 0.7, unit = "m", source = "measured", mark = "stated" }\n'
    terms = 'terms = { value = "restoring coriolis", source = "ours", mark = "assumed" }\n'
    found = given(HEAD + own + terms + TWO)
    assert found["GM_T"].value == 0.7
    assert found["GM_T"].mark == "stated"
    assert found["terms"].value == "restoring coriolis"


def test_a_submerged_craft_is_given_no_sections(given):
    deep = 'restoring = { value = "submerged", source = "ours", mark = "assumed" }\n'
    found = given(HEAD + deep + TWO)
    assert not [name for name in found if name.startswith(("section", "hull_", "windage"))]


def part(**values):
    return ShapePart.model_validate(values)


def test_an_outline_counts_each_area_once_and_only_above_the_water():
    boxes = [
        part(box=[2.0, 1.0, 0.4], at=[0.0, 0.0, 0.0]),
        part(box=[0.5, 0.5, 1.0], at=[0.5, 0.0, -0.4]),
    ]
    ahead, abeam = silhouettes(boxes, waterline=0.1)
    assert ahead.area == pytest.approx(1.0 * 0.3 + 0.5 * 0.7, rel=2e-3)
    assert abeam.area == pytest.approx(2.0 * 0.3 + 0.5 * 0.7, rel=2e-3)
    assert abeam.along == pytest.approx(0.5 * 0.35 / 0.95, rel=5e-3)
    up = (0.6 * 0.15 + 0.35 * 0.65) / 0.95
    assert abeam.up == pytest.approx(up - 0.1, rel=5e-3)


def test_a_mast_that_leans_and_what_it_carries_are_where_they_are_drawn():
    mast = part(
        cylinder={"radius": 0.05, "length": 2.0}, at=[0, 0, -1], turned=[0, 90, 0], name="m"
    )
    head = part(box=[0.2, 0.2, 0.2], at=[1.0, 0, 0], on="m")
    ahead, abeam = silhouettes([mast, head], waterline=0.0)
    assert abeam.area == pytest.approx(0.1 * 1.9 + 0.2 * 0.2, rel=0.02)
    assert ahead.area == pytest.approx(abeam.area, rel=0.02)
