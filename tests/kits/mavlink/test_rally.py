import pytest

from .bench import Bench
from .ground import RALLY, listed, north_of, one, upload

POINTS = listed(one(5100, at=north_of(100), z=-5.0), one(5100, at=north_of(0, 100)), kind=RALLY)


def bench(**settings):
    bench = Bench(**settings)
    assert upload(bench, POINTS, RALLY) == 0
    bench.tick()
    return bench


@pytest.mark.parametrize(
    ("here", "refuge"),
    [((10.0, 10.0), (0, 0)), ((60.0, 10.0), (100, 0)), ((10.0, 60.0), (0, 100)), ((49, 0), (0, 0))],
)
def test_the_nearest_of_home_and_rally_points(here, refuge):
    boat = bench()
    boat.measure(position_n=(*here, 0.0))
    boat.tick()
    assert boat.node.rally.refuge[:2] == pytest.approx(refuge, abs=0.01)


def test_it_is_kept_on_the_way():
    boat = bench()
    boat.measure(position_n=(60.0, 0.0, 0.0))
    boat.tick()
    boat.enter("return")
    boat.measure(position_n=(10.0, 0.0, 0.0))
    boat.tick()
    assert boat.node.rally.refuge[0] == pytest.approx(100.0, abs=0.01)
    boat.enter("hold")
    boat.tick()
    assert boat.node.rally.refuge == boat.vehicle.home_n


def test_home_is_followed():
    boat = bench()
    boat.enter("return")
    boat.tick()
    boat.vehicle.home_n = (7.0, 8.0, 0.0)
    assert boat.node.rally.refuge == (7.0, 8.0, 0.0)


def test_altitudes_are_relative_to_home():
    submarine = bench(submerged=True)
    submarine.vehicle.home_n = (0.0, 0.0, 1.0)
    submarine.measure(position_n=(90.0, 0.0, 0.0))
    submarine.tick()
    assert submarine.node.rally.refuge[2] == pytest.approx(6.0)


def test_without_points_it_is_home():
    boat = Bench()
    boat.vehicle.home_n = (1.0, 2.0, 3.0)
    boat.tick()
    assert boat.node.rally.refuge == (1.0, 2.0, 3.0)
