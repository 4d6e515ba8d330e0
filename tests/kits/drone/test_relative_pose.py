"""The camera that sees a landing pad, and the craft's report, against geometry and statistics."""

import math

import numpy as np
import pytest

from seatrial_kits.drone.deck_report import DeckReport
from seatrial_kits.drone.relative_pose import RelativePose

EXACT = {"noise_floor": 0.0, "noise_share": 0.0, "attitude_error": 0.0, "lost_time": 0.0}


def started(component, **values):
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    return component


def received(steps=1, **values):
    camera = started(RelativePose("camera"), delay=0.0, **values)
    found = []
    for _ in range(steps):
        found.append((camera.get("valid"), camera.get("offset")))
        camera.advance(camera.now, 0.05)
    return found


def test_an_exact_camera_gives_the_pad_from_the_drone():
    [(valid, offset)] = received(
        position=[1.0, 2.0, -4.0],
        attitude=[0.1, -0.2, 1.0],
        deck_position=[1.5, 2.2, 0.0],
        deck_attitude=[0.0, 0.0, 0.0],
        **EXACT,
    )
    assert valid
    assert offset == pytest.approx([0.5, 0.2, 3.8], abs=1e-12)


@pytest.mark.parametrize("height", [0.5, 2.0, 6.0])
def test_it_sees_within_its_cone_and_the_size_of_the_marks(height):
    edge = (height - 0.2 - 0.1) * math.tan(math.radians(40)) + 0.15
    for aside, expected in ((edge - 1e-3, True), (edge + 1e-3, False)):
        [(valid, _)] = received(position=[aside, 0.0, -height], **EXACT)
        assert valid == expected


def test_it_does_not_see_far_nor_what_is_behind_it():
    assert not received(position=[0, 0, -12.3], **EXACT)[0][0]
    assert not received(position=[0, 0, -0.3], **EXACT)[0][0]
    assert not received(position=[0, 0, -3.0], attitude=[math.pi, 0, 0], **EXACT)[0][0]


def test_noise_grows_with_distance_and_with_turning():
    values = {"attitude_error": 0.0, "lost_time": 0.0, "position": [0, 0, -4.2]}
    for extra, sigma in (({}, 0.03), ({"exposure": 0.01, "rates": [1.0, 0, 0]}, 0.07)):
        offsets = np.array([offset for _, offset in received(2000, **values, **extra)])
        assert offsets.std(axis=0) == pytest.approx([sigma] * 3, rel=0.08)


def test_the_attitudes_error_is_constant_in_a_run_and_turns_the_line_of_sight():
    values = {**EXACT, "attitude_error": math.radians(0.5), "position": [0, 0, -10.2]}
    places = []
    for seed in range(300):
        run = [offset for _, offset in received(3, seed=seed, **values)]
        assert run[0] == run[1] == run[2]
        places.append(run[0][:2])
    assert np.std(places, axis=0) == pytest.approx([10.0 * math.radians(0.5)] * 2, rel=0.12)


@pytest.mark.slow
def test_dropouts_are_a_chain_of_two_states():
    values = {**EXACT, "lost_time": 0.25, "seen_time": 5.0, "position": [0, 0, -3.0]}
    valid = np.array([valid for valid, _ in received(12_000, **values)], dtype=int)
    assert 1 - valid.mean() == pytest.approx(0.25 / 5.25, rel=0.25)
    begins = int((np.diff(valid) < 0).sum())
    assert (1 - valid).sum() * 0.05 / begins == pytest.approx(0.05 / -math.expm1(-0.2), rel=0.25)


def test_what_is_late_says_when_it_was_exposed():
    camera = started(RelativePose("camera"), position=[0, 0, -3.0], **EXACT)
    for _ in range(101):
        camera.advance(camera.now, 0.002)
    assert camera.now == pytest.approx(0.202)
    assert camera.get("exposed") == pytest.approx(0.1)


def test_the_report_has_the_pads_velocity():
    radio = started(
        DeckReport("radio"),
        delay=0.0,
        dropout=0.0,
        deck_attitude_noise=[0.0] * 3,
        deck_rates_noise=[0.0] * 3,
        pad_velocity_noise=[0.0] * 3,
        attitude=[0.0, 0.0, math.pi / 2],
        velocity=[1.0, 0.5, 0.2],
        rates=[0.1, 0.2, 0.0],
    )
    # rates x (0, 0, -0.2) = (-0.04, 0.02, 0), turned by 90 degrees.
    assert radio.get("pad_velocity") == pytest.approx([-0.52, 0.96, 0.2])
    assert radio.get("reported") == 0.0


@pytest.mark.slow
def test_errors_and_losses_of_the_report():
    radio = started(DeckReport("radio"), delay=0.0)
    names = ("deck_attitude", "deck_rates", "pad_velocity")
    found, received = [], 0
    for _ in range(10_000):
        if radio.get("valid"):
            received += 1
            found.append([*radio.get(names[0]), *radio.get(names[1]), *radio.get(names[2])])
        radio.advance(radio.now, 0.05)
    expected = [math.radians(0.3)] * 3 + [math.radians(0.2)] * 3 + [0.02] * 3
    assert np.std(found, axis=0) == pytest.approx(expected, rel=0.04)
    # 3.9 standard deviations of a share of 10 000 messages.
    assert 1 - received / 10_000 == pytest.approx(0.02, abs=3.9 * math.sqrt(0.02 * 0.98 / 10_000))
