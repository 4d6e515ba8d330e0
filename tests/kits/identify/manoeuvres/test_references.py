"""Published numbers found again from records that were computed independently of this project."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial_kits.identify.manoeuvres.replay import craft_of
from seatrial_kits.identify.manoeuvres.study import manoeuvre_study

from .passes_of import kvlcc2


def perturbed(craft, free, seed=5, share=0.3):
    """Return the craft with numbers up to 30 % off."""
    random = np.random.default_rng(seed)
    wrong = {name: craft.parameters[name] * (1.0 + share * random.uniform(-1.0, 1.0))
             for name in free}  # fmt: skip
    return replace(craft, parameters={**craft.parameters, **wrong})


def identified(vehicle, passes, free=()):
    """Return the study of a perturbed craft, and its rows with the published values."""
    published = craft_of(vehicle, None)
    free = published.free(list(free))
    found = manoeuvre_study(vehicle, passes, perturbed(published, free), free, None)
    return found, [(row, published.parameters.get(row.name, 0.0)) for row in found.rows]


SHIP = ("resistance", "Y.v", "Y.r", "N.v", "N.r", "N.vrr")


@pytest.fixture(scope="module")
def ship():
    return identified("kvlcc2", [kvlcc2("full_zigzag_20_20")], SHIP)


@pytest.fixture(scope="module")
def noisy_ship():
    return identified("kvlcc2", [kvlcc2("full_zigzag_20_20", seed=1)], SHIP)


@pytest.mark.slow
def test_derivatives_of_the_tanker_come_back_from_a_zig_zag(ship):
    found, rows = ship
    assert found.accepted
    for row, true in rows:
        if row.name in SHIP:
            assert row.is_identifiable
            assert row.value == pytest.approx(true, rel=0.02), row.name
    # Rows of 1 s hide the corners of a rudder of 2.34 deg/s.
    (shown,) = found.shown
    assert shown.rms(shown.after)[0] < 0.05 < 10.0 < shown.rms(shown.before)[0]


@pytest.mark.slow
def test_with_noise_of_gnss_and_compass_at_1_hz_intervals_hold_the_published_values(noisy_ship):
    found, rows = noisy_ship
    shown = [(row, true) for row, true in rows if row.is_identifiable and not row.is_current]
    assert {"resistance", "Y.v", "N.v", "N.r"} <= {row.name for row, _ in shown}
    for row, true in shown:
        low, high = row.interval
        assert low <= true <= high, row
        assert high - low < 0.6 * abs(true)
    (shown,) = found.shown
    track, heading = shown.rms(shown.after)
    assert track == pytest.approx(np.sqrt(2.0), rel=0.05)
    assert heading == pytest.approx(np.radians(0.3), rel=0.05)


@pytest.mark.slow
def test_a_turn_shows_the_current():
    _, rows = identified("kvlcc2", [kvlcc2("full_turn_p35_current", 2, last=1200)], SHIP[:1])
    currents = [row.value for row, _ in rows if row.is_current]
    assert currents == pytest.approx([0.5, 1.0], abs=0.005)


@pytest.mark.long
def test_all_usual_parameters_of_the_tanker_from_a_zig_zag_and_a_turn():
    passes = [kvlcc2("full_zigzag_20_20", seed=1), kvlcc2("full_turn_m35", seed=2)]
    found, rows = identified("kvlcc2", passes)
    assert found.accepted
    shown = [(row, true) for row, true in rows if row.is_identifiable and not row.is_current]
    assert {"resistance", "added_mass.x", "added_mass.y", "N.v", "N.r"} <= {
        r.name for r, _ in shown
    }
    # Of so many intervals of 95 % one may miss.
    missed = [row.name for row, true in shown if not row.interval[0] <= true <= row.interval[1]]
    assert len(missed) <= 1
    assert "N.vvv" in {row.name for row, _ in rows if not row.is_identifiable}
    assert any("N.vvr and N.vvv are hardly separable" in note for note in found.notes)
