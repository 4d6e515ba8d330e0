"""The camera's geometry against closed forms, its detections against their probabilities."""

import math

import pytest
from scipy.stats import binom, kstest

from seatrial_kits.sailing.camera import Camera
from tests.devices.running import started

IDEAL = {
    "bearing_noise": [0.0] * 6,
    "size_noise": [0.0] * 6,
    "false_detection": 0.0,
    "detection": 1.0,
}
DEG = math.radians(1)


def camera(target=(40.0, 10.0, 0.0), diameter=0.6, **settings):
    return started(Camera, **{**IDEAL, "position_1": target, "diameter_1": diameter, **settings})


def frames(component, count, *ports):
    rows = []
    for k in range(count):
        rows.append([component.get(port) for port in ports])
        component.advance(0.2 * k, 0.2)
    return rows


@pytest.mark.parametrize("heading", [0.0, 25 * DEG, -10 * DEG])
@pytest.mark.parametrize(("away", "diameter"), [((40.0, 10.0), 0.6), ((6.0, -3.0), 2.0)])
def test_bearing_and_size(away, diameter, heading):
    north, east = 100.0 + away[0], -50.0 + away[1]
    seen = camera(
        (north, east, 0.0),
        diameter,
        position=[100.0, -50.0, 0.0],
        attitude=[0, 0, heading],
        width=2.0,
    )
    distance = math.hypot(*away)
    assert seen.get("detected") == 1
    assert seen.get("bearing")[0] == pytest.approx(
        math.atan2(away[1], away[0]) - heading, abs=1e-12
    )
    # A sphere's tangent: its radius over the distance of its middle.
    assert math.sin(seen.get("size")[0] / 2) == pytest.approx(diameter / 2 / distance, rel=1e-12)
    assert seen.get("bearing_valid") == [True] + [False] * 5
    assert seen.get("kind") == [1, 0, 0, 0, 0, 0]


def test_heel_turns_the_image():
    """Rolled by a quarter turn, what is to starboard is above."""
    seen = camera((10.0, 1.0, 0.0), attitude=[math.pi / 2, 0, 0], height=47 * DEG)
    assert seen.get("bearing")[0] == pytest.approx(0.0, abs=1e-12)
    assert camera((10.0, 6.0, 0.0), attitude=[math.pi / 2, 0, 0], width=3.0).get("detected") == 0
    assert camera((10.0, 6.0, 0.0), width=3.0).get("detected") == 1


@pytest.mark.parametrize(
    ("settings", "limit"),
    [
        # Koschmieder: contrast 0.5 falls to 0.05 at V ln(10) / 3.912.
        ({"visibility": 200.0, "size_min": 0.0}, 200.0 * math.log(10) / 3.912),
        # A sphere of 0.6 m is 0.46 degrees wide at that distance.
        ({"visibility": 1e9}, 0.3 / math.sin(0.23 * DEG)),
    ],
)
def test_how_far_it_sees(settings, limit):
    for share, count in ((0.9999, 1), (1.0001, 0)):
        assert camera((share * limit, 0.0, 0.0), **settings).get("detected") == count


@pytest.mark.parametrize(("bearing", "count"), [(37.4, 1), (37.6, 0), (-37.4, 1), (180.0, 0)])
def test_field_of_view(bearing, count):
    place = 20.0 * math.cos(bearing * DEG), 20.0 * math.sin(bearing * DEG), 0.0
    assert camera(place).get("detected") == count
    aft = camera(place, direction=math.pi)
    assert aft.get("detected") == (1 if bearing == 180.0 else 0)


def test_the_lever_arm():
    seen = camera((10.0, 0.0, 0.0), place=[1.0, 2.0, 0.0])
    assert seen.get("bearing")[0] == pytest.approx(math.atan2(-2.0, 9.0))


@pytest.mark.slow
@pytest.mark.parametrize("probability", [0.9, 0.3])
def test_missed_detections(probability):
    count = 2000
    seen = sum(row[0] for row in frames(camera(detection=probability), count, "detected"))
    low, high = binom.ppf([1e-4, 1 - 1e-4], count, probability)
    assert low <= seen <= high


@pytest.mark.slow
def test_false_detections():
    count, share = 4000, 0.05
    component = camera(diameter=0.0, false_detection=share, seed=3)
    rows = [
        row for row in frames(component, count, "detected", "bearing", "kind", "count") if row[0]
    ]
    low, high = binom.ppf([1e-4, 1 - 1e-4], count, share)
    assert low <= len(rows) <= high
    bearings = [row[1][0] / (75 * DEG) + 0.5 for row in rows]
    assert kstest(bearings, "uniform").pvalue > 1e-3
    assert {row[2][0] for row in rows} == {1, 2}
    assert component.get("count") == count + 1  # an empty frame is a frame
    assert component.get("valid")


def test_the_largest_first():
    component = camera(diameter_2=2.0, position_2=[30.0, 0.0, 0.0], kind_2=2)
    assert component.get("kind")[:3] == [2, 1, 0]
    assert component.get("size")[0] > component.get("size")[1] > 0.0


def test_errors_are_those_declared():
    component = camera(bearing_noise=[0.01] * 6, size_noise=[0.001] * 6)
    rows = frames(component, 2000, "bearing", "size")
    off = [row[0][0] - math.atan2(10, 40) for row in rows]
    assert math.sqrt(sum(x * x for x in off) / len(off)) == pytest.approx(0.01, rel=0.06)


def test_other_frames_in_another_weather():
    """What is seen in haze is what would be seen without it, as far as it goes."""
    clear, hazy = (camera(detection=0.5, visibility=v, seed=5) for v in (1e9, 80.0))
    rows = zip(frames(clear, 200, "detected"), frames(hazy, 200, "detected"), strict=True)
    assert all(one == other for one, other in rows)
    assert camera((60.0, 0, 0), visibility=80.0).get("detected") == 0


@pytest.mark.parametrize(("fault", "valid"), [("off", False), ("none", True)])
def test_off_is_not_an_empty_frame(fault, valid):
    component = camera(diameter=0.0, fault=fault)
    frames(component, 3, "valid")
    assert component.get("valid") is valid


def test_what_is_not_there_is_drawn_over_the_image():
    settings = {"width": 1.1, "direction": 2.6, "false_size": 0.2, "size_min": 0.03, "seed": 2}
    component, width = camera(diameter=0.0, false_detection=0.6, **settings), 1.1
    rows = frames(component, 40, "detected", "bearing", "size", "kind")
    for k, (count, bearings, sizes, kinds) in enumerate(rows):
        there, where, how_large, what = component.generator(k, 3).random(10)[:4]
        assert count == (there < 0.6)
        if count:
            bearing = math.remainder(2.6 + (where - 0.5) * width, math.tau)
            assert bearings[0] == pytest.approx(bearing, abs=1e-12)
            assert sizes[0] == pytest.approx(0.03 + 0.17 * how_large)
            assert kinds[0] == (1 if what < 0.5 else 2)


@pytest.mark.parametrize(("elevation", "count"), [(7.9, 1), (8.1, 0), (-7.9, 1), (-8.1, 0)])
def test_the_image_has_a_height(elevation, count):
    place = (20 * math.cos(elevation * DEG), 0.0, -20 * math.sin(elevation * DEG))
    assert camera(place, height=16 * DEG).get("detected") == count


def test_from_within_nothing_is_seen():
    assert camera((0.9, 0.0, 0.0), 2.0, height=3.0).get("detected") == 0
    assert camera((1.1, 0.0, 0.0), 2.0, height=3.0).get("detected") == 1
