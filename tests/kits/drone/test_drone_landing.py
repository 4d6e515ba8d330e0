"""Landings of the shipped rigs: on a deck at rest, in waves, with what goes wrong."""

import math

import numpy as np
import pytest

import seatrial

WAVES = {"deck.raft.wave_height": 0.3, "wind.mean_speed": 5.5}


def flown(stop, set=None, seed=1, events=(), start=-2.45, **choices):
    """Return a simulation that has run to ``stop`` s, or until the landing was decided."""
    sim = seatrial.Simulation(
        "drone-landing",
        set={"drone.body.position_start": [0.0, 0.0, start], **(set or {})},
        choices=choices,
        seed=seed,
        engine="direct",
    )
    for at, change in events:
        sim.run(at)
        change(sim)
    while sim.time < stop and not value(sim, "drone.landed"):
        sim.run(min(sim.time + 1.0, stop))
    return sim


def value(sim, name):
    return float(np.ravel(sim.get(name))[0])


HARDEST = {"naive": 1.25 * 0.50, "relative": 1.25 * 0.43, "predictive": 1.25 * 0.68}
"""Normal speed at the touch, m/s: the independent benchmark's 95th percentiles in the calmest sea
(0.1 m, 3 m/s), of which a deck at rest must be within its 25 %."""


@pytest.mark.slow
@pytest.mark.parametrize("control", list(HARDEST))
@pytest.mark.parametrize("drone", ["huauv", "x500"])
def test_it_lands_on_a_deck_at_rest(control, drone):
    # A deck at rest has a period of 1 s.
    with flown(40.0, control=control, drone=drone) as sim:
        assert value(sim, "drone.landed") == 1.0
        assert value(sim, "drone.touch_error") < 0.10
        assert value(sim, "drone.touch_speed") < HARDEST[control]
        assert value(sim, "drone.mode") == 6.0


@pytest.mark.slow
@pytest.mark.parametrize("at", [5.0, 5.8, 6.6, 7.0])
def test_a_mark_that_is_lost_for_a_second_is_no_crash(at):
    faults = []
    events = [
        (at, lambda sim: faults.append(sim.inject("off", "drone.camera"))),
        (at + 1.0, lambda sim: faults[0].clear()),
    ]
    with flown(40.0, WAVES, events=events) as sim:
        assert value(sim, "drone.landed") == 1.0
        assert value(sim, "drone.go_arounds") == (1.0 if at < 6.0 else 0.0)


@pytest.mark.slow
def test_a_mark_that_never_comes_back_is_no_landing():
    events = [(5.5, lambda sim: sim.inject("off", "drone.camera"))]
    with flown(30.0, WAVES, events=events) as sim:
        assert value(sim, "drone.landed") == 0.0
        assert value(sim, "drone.mode") == 7.0
        place = np.ravel(sim.get("drone.body.position"))
        assert np.hypot(*place[:2]) < 1.0
        assert place[2] == pytest.approx(-2.45, abs=0.5)


@pytest.mark.slow
def test_without_the_mark_no_landing_is_tried():
    with flown(20.0, {**WAVES, "drone.camera.reach": 0.1}) as sim:
        assert value(sim, "drone.mode") == 3.0
        assert np.ravel(sim.get("drone.body.position"))[2] == pytest.approx(-2.45, abs=0.2)


@pytest.mark.slow
def test_it_takes_off_flies_out_and_comes_back():
    out = {
        **WAVES,
        "drone.body.rotor_speed_start": [0.0] * 4,
        "drone.landing.starts_from": "deck",
        "drone.landing.waypoint": [6.0, 3.0],
    }
    with flown(3.0, out, start=-0.45) as sim:
        assert value(sim, "drone.mode") == 2.0
        nearest = math.inf
        while sim.time < 60.0 and not value(sim, "drone.landed"):
            sim.run(round(sim.time + 0.1, 9))
            place = [value(sim, f"drone.body.position.{axis}") for axis in "xy"]
            nearest = min(nearest, math.dist(place, (6.0, 3.0)))
        assert nearest < 1.0
        assert value(sim, "drone.landed") == 1.0


@pytest.mark.slow
def test_wind_from_the_stern_does_not_carry_it_over_the_edge():
    gale = {**WAVES, "wind.mean_speed": 12.0, "wind.direction_by": "value", "wind.direction": 0.0}
    with flown(60.0, gale) as sim:
        assert value(sim, "drone.landed") == 1.0
        assert value(sim, "drone.touch_error") < 0.30


@pytest.mark.slow
def test_the_same_seed_has_the_same_bytes_and_another_another():
    places = []
    for seed in (1, 1, 2):
        with flown(3.0, WAVES, seed=seed) as sim:
            places.append(np.ravel(sim.get("drone.body.position")).tolist())
    assert places[0] == places[1] != places[2]
