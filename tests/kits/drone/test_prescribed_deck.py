"""Decks that follow the waves against independent series, statistics, and bad files."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.drone.low_altitude_wind import LowAltitudeWind
from seatrial_kits.drone.prescribed_deck import PrescribedDeck

HERE = Path(__file__).parents[2] / "reference" / "drone"


def started(component, **values):
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    return component


def pad(deck):
    return [
        *deck.get("pad_position"),
        *deck.get("pad_velocity"),
        *deck.get("attitude"),
        *deck.get("rates"),
    ]


@pytest.mark.parametrize("name", ["deck-hydrone-0.3", "deck-wamv-1.88"])
def test_a_deck_of_a_file_moves_as_its_components(name):
    deck = started(PrescribedDeck("deck"), file=str(HERE / f"{name}.json"))
    for row in np.genfromtxt(HERE / f"{name}.csv", delimiter=",", skip_header=1)[:300]:
        while deck.now < row[0] - 1e-9:
            deck.advance(deck.now, 0.1)
        np.testing.assert_allclose(pad(deck), row[1:], atol=2e-8)


def test_velocity_and_rates_are_those_of_its_motion():
    deck = started(PrescribedDeck("deck"), wave_height=0.5, wave_direction=1.0)
    h, before, rates = 1e-4, None, None
    for _ in range(3):
        now = [deck.get("position"), deck.get("attitude")]
        if before is not None:
            moved = (np.array(now[0]) - before[0]) / h
            turned = (np.array(now[1]) - before[1]) / h
        before, rates = [np.array(each) for each in now], deck.get("rates")
        attitude, velocity = now[1], deck.get("velocity")
        deck.advance(deck.now, h)
    from scipy.spatial.transform import Rotation

    own = Rotation.from_euler("ZYX", attitude[::-1])
    np.testing.assert_allclose(moved, own.apply(velocity), atol=1e-4)
    assert turned[:2] == pytest.approx([rates[0], rates[1] / math.cos(attitude[0])], abs=1e-4)


@pytest.mark.parametrize(
    ("height", "size", "above", "heave", "tilt"),
    [
        (0.3, (1.168, 0.517, 0.043), 0.2, 0.067, 4.843),
        (1.88, (4.05, 2.44, 0.15), 1.0, 0.448, 5.723),
    ],
)
def test_statistics_of_drawn_decks(height, size, above, heave, tilt):
    downs, tilts = [], []
    for seed in range(16):
        deck = started(
            PrescribedDeck("deck"),
            wave_height=height,
            size=list(size),
            pad_height=above,
            direction_by="seed",
            seed=seed,
        )
        for _ in range(200):
            deck.advance(deck.now, 0.5)
            phi, theta, _ = deck.get("attitude")
            downs.append(deck.get("pad_position")[2])
            tilts.append(math.degrees(math.acos(math.cos(phi) * math.cos(theta))))
    assert np.std(downs) == pytest.approx(heave, rel=0.08)
    assert math.sqrt(np.mean(np.square(tilts))) == pytest.approx(tilt, rel=0.08)


def test_a_deck_at_rest():
    deck = started(PrescribedDeck("deck"))
    deck.advance(0.0, 0.5)
    assert pad(deck) == pytest.approx([0, 0, -0.2, *[0.0] * 9], abs=1e-12)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"omega [rad/s]": [1.0]}, "one length"),
        ({"phase [rad]": None}, "missing or no list"),
        ({"Tp [s]": 0.0}, "above 0"),
        ({"pad height [m]": "high"}, "finite number"),
        ({"amplitude [m]": ["a"] * 60}, r"\[0\] is 'a'"),
    ],
)
def test_files_that_are_refused(tmp_path, change, said):
    content = json.loads((HERE / "deck-hydrone-0.3.json").read_text()) | change
    file = tmp_path / "deck.json"
    file.write_text(repr(content))
    with pytest.raises(InputError, match=said):
        started(PrescribedDeck("deck"), file=str(file))


@pytest.mark.parametrize("text", ["", "[1, 2]", '{"omega [rad/s]": [NaN]}', "{" * 500])
def test_files_that_are_no_object(tmp_path, text):
    file = tmp_path / "deck.json"
    file.write_text(text)
    with pytest.raises(InputError, match=r"deck\.json"):
        started(PrescribedDeck("deck"), file=str(file))


def test_a_seed_gives_the_wind_its_direction():
    for seed in (1, 2, 3):
        drawn = started(LowAltitudeWind("wind"), mean_speed=5.0, direction_by="seed", seed=seed)
        to = 2 * math.pi * float(drawn.generator(0, 1).random())
        given = started(LowAltitudeWind("wind"), mean_speed=5.0, direction=to, seed=seed)
        assert drawn.get("velocity") == pytest.approx(given.get("velocity"), rel=1e-12)


def test_the_first_gusts_are_along_across_and_down():
    wind = started(LowAltitudeWind("wind"), mean_speed=8.0, direction=0.7)
    along, aside, down = wind.generator(0).standard_normal(3)
    across = 0.1 * 8.0 / (0.177 + 0.000823 * 20) ** 0.4
    level = (8.0 + across * along + 1j * across * aside) * np.exp(0.7j)
    expected = [level.real, level.imag, 0.1 * 8.0 * 0.3 * down]
    assert wind.get("velocity") == pytest.approx(expected, rel=1e-12)


def test_without_a_vertical_share_the_wind_is_level():
    wind = started(LowAltitudeWind("wind"), mean_speed=5.0, vertical_share=0.0)
    for _ in range(5):
        assert wind.get("velocity")[2] == 0.0
        wind.advance(wind.now, 0.1)


@pytest.mark.slow
def test_gusts_have_the_intensity_of_the_specification():
    wind = started(LowAltitudeWind("wind"), mean_speed=10.0, direction=math.pi / 2)
    seen = []
    for _ in range(12_000):
        wind.advance(wind.now, 0.1)
        seen.append(wind.get("velocity"))
    north, east, down = np.array(seen).T
    across = 0.1 * 10.0 / (0.177 + 0.000823 * 20) ** 0.4
    assert east.mean() == pytest.approx(10.0, abs=0.2)
    assert east.std() == pytest.approx(across, rel=0.08)
    assert north.std() == pytest.approx(across, rel=0.08)
    assert down.std() == pytest.approx(0.3, rel=0.08)
    # Correlation of a first-order lag of 43.7 m: 1 s apart.
    apart = np.corrcoef(north[:-10], north[10:])[0, 1]
    assert apart == pytest.approx(
        math.exp(-10.0 / (20 / (0.177 + 0.01646) ** 1.2 * 0.3048)), abs=0.03
    )
