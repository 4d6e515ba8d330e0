"""Echo sounders, DVL and sonar over a known bottom, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial_kits.underwater.dvl import Dvl
from seatrial_kits.underwater.echo_sounder import Altimeter, EchoSounder
from seatrial_kits.underwater.scanning_sonar import BINS, ScanningSonar
from tests.devices.ideal import ideal
from tests.devices.running import run, started

DEG = math.radians(1.0)
small = st.floats(-0.3, 0.3)
speed = st.floats(-1.0, 1.0)

# ------------------------------------------------------------------ echo sounder


def test_depth_below_the_transducer_on_a_level_bottom():
    sounder = ideal(EchoSounder, seabed_depth=20.0, place=[0.0, 0.0, 0.5])
    assert sounder.get("distance") == pytest.approx(19.5)
    assert sounder.get("valid")


@pytest.mark.parametrize("roll", [0.0, 5.0, 25.0])
def test_a_roll_within_the_beam_changes_nothing(roll):
    sounder = ideal(EchoSounder, seabed_depth=20.0, attitude=[roll * DEG, 0.0, 0.0])
    outside = max(0.0, roll - 6.0) * DEG
    assert sounder.get("distance") == pytest.approx(20.0 / math.cos(outside), rel=1e-6)


def test_the_instrument_reckons_with_the_speed_of_sound_it_is_set_to():
    sounder = ideal(EchoSounder, seabed_depth=20.0, sound_speed=1450.0)
    assert sounder.get("distance") == pytest.approx(20.0 * 1500.0 / 1450.0)


@pytest.mark.parametrize(
    "values",
    [
        {"seabed_depth": 0.3},
        {"seabed_depth": 101.0},
        {},
        {"seabed_depth": 20.0, "position": [0.0, 0.0, -0.1]},
    ],
)
def test_too_near_too_far_no_bottom_and_out_of_the_water(values):
    sounder = ideal(EchoSounder, **values)
    assert not sounder.get("valid")
    assert sounder.get("count") == 0


def test_what_was_lost_keeps_the_measurement_before():
    sounder = ideal(EchoSounder, seabed_depth=50.0, period=0.1)

    def rise(t_ms):
        return {"position": [0.0, 0.0, 10.0 if t_ms < 300 else -5.0]}

    rows = run(sounder, ["distance", "valid", "count"], 500, 100, rise)
    assert rows[2] == [pytest.approx(40.0), True, 3]
    assert rows[3:] == [[pytest.approx(40.0), False, 3]] * 3


def test_an_altimeter_looks_where_its_axis_points():
    ahead = ideal(
        Altimeter,
        axis=[1.0, 0.0, 0.0],
        obstacles="box 10 0 5 2 20 20 0",
        position=[0.0, 0.0, 5.0],
        beam_width=0.0,
    )
    assert ahead.get("distance") == pytest.approx(9.0)
    with pytest.raises(InputError, match=r"axis is \(1\.0, 1\.0, 0\.0\), of length 1\.41421"):
        started(Altimeter, axis=[1.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("fault", "check"),
    [
        ("off", lambda rows: not any(row[1] for row in rows[3:])),
        ("stuck", lambda rows: all(row[1] and row[0] == rows[2][0] for row in rows[3:])),
        ("wrong", lambda rows: all(row[0] == pytest.approx(20.0 + 10.0) for row in rows[3:])),
        ("garbage", lambda rows: len({row[0] for row in rows[3:]}) == len(rows[3:])),
    ],
)
def test_failures(fault, check):
    sounder = ideal(EchoSounder, seabed_depth=20.0, period=0.1)
    rows = run(
        sounder,
        ["distance", "valid"],
        1000,
        100,
        lambda t: {"fault": fault if t >= 300 else "none"},
    )
    assert check(rows)


# ------------------------------------------------------------------ DVL


@given(
    st.tuples(small, small, st.floats(-7, 7)),
    st.tuples(speed, speed, speed),
    st.tuples(speed, speed, speed),
)
def test_beams_give_back_the_velocity(attitude, velocity, rates):
    place = [0.3, -0.1, 0.2]
    dvl = ideal(
        Dvl,
        seabed_depth=12.0,
        seabed_slope=0.1,
        position=[1.0, 2.0, 3.0],
        attitude=attitude,
        velocity=velocity,
        rates=rates,
        place=place,
        current=[0.2, -0.3, 0.0],
    )
    phi, theta, psi = attitude
    R = Rotation.from_euler("ZYX", [psi, theta, phi])
    expected = np.array(velocity) + np.cross(rates, place)
    assert dvl.get("velocity_b_valid")
    assert dvl.get("velocity_b") == pytest.approx(expected, abs=1e-9)
    assert dvl.get("velocity_n") == pytest.approx(R.apply(expected), abs=1e-9)
    water = expected - R.inv().apply([0.2, -0.3, 0.0])
    assert dvl.get("water_velocity_b") == pytest.approx(water, abs=1e-9)


def test_water_track_is_relative_to_the_trials_current_at_its_depth():
    layers = {
        "current_profile": "layers",
        "current_layers": 2,
        "current_layer_depths": [0.0, 10.0, *[0.0] * 6],
        "current_layer_speeds": [1.0, 0.2, *[0.0] * 6],
    }
    dvl = ideal(Dvl, seabed_depth=12.0, position=[0.0, 0.0, 4.0], place=[0.0, 0.0, 1.0], **layers)
    assert dvl.get("water_velocity_b") == pytest.approx([-0.6, 0.0, 0.0], abs=1e-9)
    assert dvl.get("velocity_b") == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_ranges_and_altitude_over_a_level_bottom():
    dvl = ideal(Dvl, seabed_depth=12.0, position=[0.0, 0.0, 2.0])
    assert dvl.get("ranges") == pytest.approx([10.0 / math.cos(22.5 * DEG)] * 4)
    assert dvl.get("altitude") == pytest.approx(10.0)


def test_beams_look_ahead_and_aft_port_and_starboard():
    # Down by the bow: the beams ahead, 1 (starboard) and 4 (port), are the shorter ones.
    dvl = ideal(Dvl, seabed_depth=12.0, position=[0.0, 0.0, 2.0], attitude=[0.0, -0.2, 0.0])
    one, two, three, four = dvl.get("ranges")
    assert one == pytest.approx(four)
    assert two == pytest.approx(three)
    rolled = ideal(Dvl, seabed_depth=12.0, position=[0.0, 0.0, 2.0], attitude=[0.2, 0.0, 0.0])
    one, two, three, four = rolled.get("ranges")  # starboard down: port beams look at the bottom
    assert one == pytest.approx(two)
    assert four == pytest.approx(three)
    assert one != pytest.approx(four)


@pytest.mark.parametrize("beam_angle", [15.0, 30.0])
def test_noise_of_a_beam_makes_the_published_noise_of_the_velocity(beam_angle):
    angle, deviation, n = beam_angle * DEG, 0.01, 500
    dvl = ideal(
        Dvl, seabed_depth=20.0, beam_angle=angle, bottom_noise=deviation, period=0.01
    )  # fmt: skip
    found = np.array([row[0] for row in run(dvl, ["velocity_b"], 10 * n, 10)])
    expected = [
        deviation / (math.sqrt(2.0) * math.sin(angle)),
        deviation / (math.sqrt(2.0) * math.sin(angle)),
        deviation / (2.0 * math.cos(angle)),
    ]
    assert found.std(axis=0) == pytest.approx(expected, rel=4.0 / math.sqrt(2.0 * n))
    assert np.abs(found.mean(axis=0)).max() < 4.0 * max(expected) / math.sqrt(n)


def test_three_beams_are_enough_and_two_are_not():
    values = {"seabed_depth": 12.0, "velocity": [0.5, 0.2, 0.1], "position": [0.0, 0.0, 2.0]}
    # Pillars up to the array in the way of beams 1 and 2 make their ranges too short.
    one = "cylinder 1 1 4 1 1 12 .6"
    two = "cylinder -1 1 4 -1 1 12 .6"
    three = ideal(Dvl, range_min=9.0, obstacles=one, **values)
    assert three.get("bottom_valid") == [False, True, True, True]
    assert three.get("velocity_b") == pytest.approx([0.5, 0.2, 0.1])
    lost = ideal(Dvl, range_min=9.0, obstacles=f"{one}; {two}", **values)
    assert lost.get("bottom_valid") == [False, False, True, True]
    assert not lost.get("velocity_b_valid")
    assert lost.get("velocity_b") == [0.0, 0.0, 0.0]
    assert lost.get("valid")  # it answers all the same


@pytest.mark.parametrize(
    ("values", "over_bottom", "through_water"),
    [
        ({"seabed_depth": 20.0}, True, True),
        ({"seabed_depth": 5.0}, True, False),  # the layer would be in the bottom
        ({"seabed_depth": 60.0}, False, True),
        ({}, False, True),
        ({"seabed_depth": 20.0, "attitude": [50.0 * DEG, 0.0, 0.0]}, False, False),
        ({"seabed_depth": 20.0, "velocity": [4.0, 0.0, 0.0]}, False, False),
        ({"seabed_depth": 20.0, "position": [0.0, 0.0, -0.5]}, False, False),
    ],
)
def test_what_is_valid(values, over_bottom, through_water):
    dvl = ideal(Dvl, **{"position": [0.0, 0.0, 1.0], **values})
    assert dvl.get("velocity_b_valid") == dvl.get("altitude_valid") == over_bottom
    assert dvl.get("water_velocity_b_valid") == through_water


def test_validity_comes_with_the_measurement_after_the_delay():
    dvl = ideal(Dvl, seabed_depth=20.0, period=0.2, delay=0.1)
    rows = run(
        dvl,
        ["velocity_b_valid", "velocity_b"],
        500,
        50,
        lambda t: {"velocity": [1.0 if t < 200 else 9.0, 0.0, 0.0]},
    )
    assert [row[0] for row in rows] == [False] * 2 + [True] * 4 + [False] * 4 + [False]
    assert rows[5][1] == pytest.approx([1.0, 0.0, 0.0])


# ------------------------------------------------------------------ sonar


def test_a_wall_face_to_face_returns_all():
    sonar = ideal(
        ScanningSonar,
        obstacles="box 11 0 50 2 60 100 0",
        position=[0.0, 0.0, 50.0],
        width=0.0,
        height=1e-6,
    )
    bins = sonar.get("intensity")
    assert sonar.get("distance") == pytest.approx(10.0, abs=10.0 / BINS)
    assert sum(bins) == pytest.approx(1.0)
    assert max(bins) == pytest.approx(1.0)


def test_lambert_on_a_bottom_by_hand():
    sonar = ideal(ScanningSonar, seabed_depth=5.0, position=[0.0, 0.0, 1.0], height=60.0 * DEG)
    expected = [0.0] * BINS
    for j in range(15):
        dive = 60.0 * DEG * ((j + 0.5) / 15 - 0.5)
        if dive > 0.0 and 4.0 / math.sin(dive) < 20.0:
            expected[int(BINS * 4.0 / math.sin(dive) / 20.0)] += 0.3 * math.sin(dive) ** 2 / 15
        elif dive < 0.0 and 1.0 / math.sin(-dive) < 20.0:
            expected[int(BINS * 1.0 / math.sin(-dive) / 20.0)] += 0.5 * math.sin(dive) ** 2 / 15
    assert sonar.get("intensity") == pytest.approx(expected)


def test_a_head_goes_round_and_finds_the_pile():
    pile = "cylinder 0 8 0 0 8 20 .5"  # abeam to starboard
    sonar = ideal(
        ScanningSonar, obstacles=pile, position=[0.0, 0.0, 10.0], attitude=[0.0, 0.0, 0.3]
    )
    rows = run(sonar, ["angle", "distance_valid", "distance"], 19_900, 100)
    assert [row[0] for row in rows[:3]] == pytest.approx([0.0, 1.8 * DEG, 3.6 * DEG])
    seen = [row for row in rows if row[1]]
    middle = sum(row[0] for row in seen) / len(seen)
    assert middle == pytest.approx(90.0 * DEG - 0.3, abs=1.8 * DEG)
    assert all(row[2] == pytest.approx(7.6, abs=0.3) for row in seen)


def test_a_sector_is_scanned_to_and_fro():
    sonar = ideal(ScanningSonar, angle_start=-10.0 * DEG, sector=20.0 * DEG, step_angle=5.0 * DEG,
                  position=[0.0, 0.0, 10.0])  # fmt: skip
    found = [row[0] / DEG for row in run(sonar, ["angle"], 900, 100)]
    assert found == pytest.approx([350, 355, 0, 5, 10, 5, 0, 355, 350, 355], abs=1e-9)


def test_a_single_beam_sonar_stands_still():
    sonar = ideal(ScanningSonar, step_angle=0.0, angle_start=0.5, position=[0.0, 0.0, 10.0])
    assert {row[0] for row in run(sonar, ["angle"], 900, 100)} == {0.5}
