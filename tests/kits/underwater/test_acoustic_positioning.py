"""USBL and LBL: places, times of travel, outliers; and GNSS below the surface."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial.devices.gnss import Gnss
from seatrial.errors import InputError
from seatrial_kits.underwater.lbl import Lbl
from seatrial_kits.underwater.usbl import Usbl
from tests.devices.ideal import ideal
from tests.devices.running import run, started

far = st.floats(-150.0, 150.0)
deep = st.floats(1.0, 90.0)
tilt = st.floats(-0.4, 0.4)

NET = {
    "transponders": 4.0,
    "transponder_1": [100.0, 0.0, 50.0],
    "transponder_2": [-80.0, 60.0, 55.0],
    "transponder_3": [0.0, -90.0, 45.0],
    "transponder_4": [30.0, 120.0, 60.0],
}


def answered(sensor, seconds=4):
    """Return a sensor after the answer to its first question."""
    for k in range(10 * seconds):
        if sensor.get("count"):
            break
        sensor.advance(0.1 * k, 0.1)
    return sensor


@given(st.tuples(far, far, deep), st.tuples(tilt, tilt, far), st.tuples(tilt, tilt, far))
def test_usbl_finds_the_transponder(position, attitude, lies):
    def turned(euler):
        return Rotation.from_euler("ZYX", euler[::-1])

    usbl = answered(
        ideal(
            Usbl,
            position=position,
            attitude=attitude,
            place=[0.5, 0.1, 0.2],
            station_position=[20.0, -30.0, 0.0],
            station_attitude=lies,
            transceiver=[0.0, 0.0, 3.0],
        )
    )
    place = np.array(position) + turned(attitude).apply([0.5, 0.1, 0.2])
    head = np.array([20.0, -30.0, 0.0]) + turned(lies).apply([0.0, 0.0, 3.0])
    x, y, z = turned(lies).inv().apply(place - head)
    assert usbl.get("range") == pytest.approx(math.dist(place, head))
    assert math.cos(usbl.get("bearing") - math.atan2(y, x)) == pytest.approx(1.0)
    assert usbl.get("depression") == pytest.approx(math.atan2(z, math.hypot(x, y)))
    assert usbl.get("position_n") == pytest.approx(place, abs=1e-9)


def test_a_fix_arrives_when_the_sound_has_been_there_and_back():
    usbl = ideal(Usbl, position=[300.0, 0.0, 1.0], delay=0.05, station_position=[0.0, 0.0, 0.0])
    rows = run(usbl, ["valid", "count"], 2000, 10)
    late = 2.0 * 300.0 / 1500.0 + 0.05
    first = next(k for k, row in enumerate(rows) if row[0])
    assert first * 0.01 == pytest.approx(late, abs=0.0101)
    assert [row[1] for row in rows].index(2) == first + 100


def test_no_answer_is_known_when_the_time_for_it_is_over():
    usbl = ideal(Usbl, position=[100.0, 0.0, 1.0])

    def away(t_ms):
        return {"position": [100.0 if t_ms < 500 else 600.0, 0.0, 1.0]}

    rows = run(usbl, ["valid", "count"], 2500, 10, away)
    lost = next(k for k, row in enumerate(rows) if k > 50 and not row[0])
    assert lost * 0.01 == pytest.approx(1.0 + 2.0 * 500.0 / 1500.0, abs=0.0101)
    assert rows[-1][1] == 1


@pytest.mark.parametrize("depths", [(-0.5, 0.0), (5.0, -4.0)])
def test_nothing_answers_out_of_the_water(depths):
    usbl = ideal(Usbl, position=[9.0, 0.0, depths[0]], station_position=[0.0, 0.0, depths[1]])
    assert run(usbl, ["count"], 3000, 100)[-1] == [0]


def test_a_wrong_speed_of_sound_scales_the_place():
    usbl = answered(ideal(Usbl, position=[150.0, 0.0, 1.0], sound_speed=1450.0))
    assert usbl.get("position_n")[0] == pytest.approx(150.0 * 1500.0 / 1450.0)


def test_outliers_come_as_often_as_they_should_and_too_far():
    n, share = 1500, 0.2
    usbl = ideal(Usbl, position=[30.0, 0.0, 1.0], outlier=share, period=0.1, outlier_range=20.0)
    ranges = np.array([row[0] for row in run(usbl, ["range", "count"], 100 * n, 100)][2:])
    wrong = ranges > 30.0 + 1e-9
    assert wrong.mean() == pytest.approx(share, abs=4.0 * math.sqrt(share * 0.8 / n))
    assert ranges.min() == pytest.approx(30.0)
    assert 49.0 < ranges.max() < 50.0
    assert ranges[wrong].mean() == pytest.approx(40.0, abs=4.0 * 5.8 / math.sqrt(share * n))


def test_noise_across_grows_with_the_range():
    n, places = 400, {}
    for away in (30.0, 300.0):
        usbl = ideal(Usbl, position=[away, 0.0, 1.0], bearing_noise=0.01, period=0.5)
        rows = run(usbl, ["position_n"], 500 * n, 500)[2:]
        places[away] = np.array([row[0][1] for row in rows]).std()
    assert places[30.0] == pytest.approx(0.3, rel=0.2)
    assert places[300.0] == pytest.approx(3.0, rel=0.2)


@given(far, far, deep)
def test_lbl_finds_the_place_without_errors(north, east, down):
    lbl = answered(ideal(Lbl, position=[north, east, down], **NET))
    assert lbl.get("position_n_valid")
    assert lbl.get("position_n") == pytest.approx([north, east, down], abs=1e-6)
    assert lbl.get("ranges_valid") == [True] * 4 + [False] * 2
    assert lbl.get("ranges")[0] == pytest.approx(math.dist((north, east, down), (100, 0, 50)))


@pytest.mark.parametrize(
    ("values", "ranges"),
    [
        ({"range_max": 120.0}, 3),
        ({"transponders": 2.0}, 2),
        ({"transponder_2": [50.0, 0.0, 5.0], "transponder_3": [-90.0, 0.0, 9.0], "transponders": 3.0}, 3),
    ],
)  # fmt: skip
def test_a_place_needs_three_ranges_to_a_triangle(values, ranges):
    lbl = answered(ideal(Lbl, **{**NET, **values, "position": [0.0, 0.0, 40.0]}))
    assert sum(lbl.get("ranges_valid")) == ranges
    assert lbl.get("position_n_valid") == ("range_max" in values)


def test_lbl_answers_when_the_farthest_has():
    lbl = ideal(Lbl, position=[0.0, 0.0, 40.0], delay=0.0, **NET)
    rows = run(lbl, ["count"], 1000, 10)
    late = 2.0 * math.dist((0, 0, 40), (30, 120, 60)) / 1500.0
    assert next(k for k, row in enumerate(rows) if row[0]) * 0.01 == pytest.approx(late, abs=0.0101)


def test_lbl_error_is_the_least_squares_prediction():
    n, deviation = 300, 0.5
    lbl = ideal(Lbl, position=[5.0, 7.0, 40.0], ranges_noise=deviation, period=0.5, **NET)
    found = np.array([row[0][:2] for row in run(lbl, ["position_n"], 500 * n, 500)[2:]])
    fixed = np.array([NET[f"transponder_{k}"] for k in range(1, 5)])
    away = np.array([5.0, 7.0, 40.0]) - fixed
    rows = (away / np.linalg.norm(away, axis=1)[:, None])[:, :2]
    expected = deviation * np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    assert found.std(axis=0) == pytest.approx(expected, rel=4.0 / math.sqrt(2 * n))


def test_transponders_are_whole():
    with pytest.raises(InputError, match=r"transponders is 2\.5, a whole number"):
        started(Lbl, transponders=2.5)


def test_gnss_below_the_surface_receives_nothing():
    values = {"antenna": [0.0, 0.0, -0.5], "period": 0.1}
    gnss = ideal(Gnss, **values)
    rows = run(
        gnss, ["valid", "count"], 400, 100, lambda t: {"position": [0, 0, 0.4 if t < 200 else 0.6]}
    )
    assert rows == [[True, 1], [True, 2], [False, 2], [False, 2], [False, 2]]
    everywhere = ideal(Gnss, reception="everywhere", position=[0, 0, 9.0], **values)
    assert everywhere.get("valid")


def received(sensor, outputs, count):
    """Return what is received of each of ``count`` questions, one a second, at rest."""
    rows = []
    for k in range(count):
        sensor.advance(float(k), 0.9)
        rows.append([sensor.get(name) for name in outputs])
        sensor.advance(k + 0.9, 0.1)
    return rows


def test_a_reflection_comes_from_farther_and_anywhere():
    places = {"position": [30.0, 40.0, 2.0], "station_position": [3.0, 4.0, 1.0]}
    usbl = ideal(Usbl, **places, period=1.0, outlier=0.4, outlier_range=25.0, seed=3)
    away, bearing = 45.0, math.atan2(36.0, 27.0)
    for k, (distance, seen) in enumerate(received(usbl, ["range", "bearing"], 20)):
        reflected, farther, turned = usbl.generator(k, 2).random(3)
        more = reflected < 0.4
        assert distance == pytest.approx(away + more * farther * 25.0)
        assert seen == pytest.approx((bearing + more * math.tau * turned) % math.tau)


def test_each_range_of_a_net_has_reflections_of_its_own():
    place = np.array([5.0, -8.0, 3.0])
    lbl = ideal(Lbl, **NET, position=place, period=1.0, outlier=0.4, outlier_range=25.0, seed=3)
    away = [math.dist(NET[f"transponder_{n}"], place) for n in range(1, 5)]
    for k, (ranges,) in enumerate(received(lbl, ["ranges"], 15)):
        drawn = lbl.generator(k, 2).random((len(ranges), 2))
        late = np.where(drawn[:, 0] < 0.4, 25.0 * drawn[:, 1], 0.0)
        np.testing.assert_allclose(ranges[:4], away + late[:4])
