"""Random commands: how they are spread, held and sent to the motors."""

import numpy as np
import pytest

from seatrial_kits.identify.excitation import Excitation


def commands(count=2000, step=0.1, **settings):
    excitation = Excitation("excitation")
    for name, value in settings.items():
        excitation.set(name, value)
    excitation.initialise()
    excitation.begin()
    found = []
    for k in range(count):
        found.append([excitation.get(n) for n in ("command", "port", "starboard", "vertical")])
        excitation.advance(k * step, step)
    return np.array(found)


def test_each_amplitude_is_held_for_its_period():
    command = commands(period=0.7)[:, 0]
    (changes,) = np.nonzero(np.diff(command))
    assert set((changes + 1) % 7) == {0}
    assert len(changes) > 270


def test_amplitudes_are_spread_evenly_and_white():
    levels = commands(count=4000, step=1.0, amplitude=0.3)[:, 0]
    assert np.abs(levels).max() == 0.3
    np.testing.assert_allclose(levels / 0.003, np.round(levels / 0.003), atol=1e-9)
    # Even over 201 levels: variance 100 * 101 / 3 of a level; 4000 draws give it to 2 %.
    assert levels.var() == pytest.approx(0.003**2 * 100 * 101 / 3, rel=0.05)
    assert abs(levels.mean()) < 4 * levels.std() / np.sqrt(4000)
    correlation = [levels[lag:] @ levels[: len(levels) - lag] for lag in range(1, 20)]
    assert np.abs(correlation).max() / (levels @ levels) < 4 / np.sqrt(4000)


@pytest.mark.parametrize(
    ("axis", "signs"), [("surge", (1, 1, 0)), ("yaw", (1, -1, 0)), ("heave", (0, 0, 1))]
)
def test_motors(axis, signs):
    command, *motors = commands(count=50, axis=axis, amplitude=1.0).T
    for motor, sign in zip(motors, signs, strict=True):
        np.testing.assert_array_equal(motor, sign * command)


def test_rest_and_seed():
    command = commands(count=100, rest=3.0)[:, 0]
    assert not command[:30].any()
    assert command[30:].any()
    first, again, other = (commands(count=100, seed=seed)[:, 0] for seed in (1.0, 1.0, 2.0))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
