"""Probabilities of rare events by splitting copies in time, against the walk's own."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from seatrial import Batch, InputError

pytestmark = [
    pytest.mark.slow,  # the compiler takes seconds
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

PARTS = Path(__file__).with_name("parts.py")
COPIES, STEPS = 1000, 20


@pytest.fixture(scope="module")
def walkers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Batch]:
    path = tmp_path_factory.mktemp("walk") / "walk.toml"
    path.write_text(f'step = "10 ms"\n[components]\nw = {{ fmu = "{PARTS}:Walker" }}\n', "utf-8")
    with Batch(path, COPIES) as batch:
        yield batch


def of_walk(level: float) -> float:
    """Return P(max of x_1 ... x_20 >= level) of a walk of standard normal steps, by quadrature.

    The density of walks that were below so far is integrated step by step (trapezoids of 0.02,
    from 60 below the level on): to 1e-6 of the probability.
    """
    x = np.linspace(level - 60.0, level, 3001)
    weights = np.full(len(x), x[1] - x[0])
    weights[[0, -1]] *= 0.5

    def density(of: np.ndarray) -> np.ndarray:
        return np.exp(-0.5 * of**2) / np.sqrt(2.0 * np.pi)

    below, step = density(x), density(x[:, None] - x[None, :])
    for _ in range(STEPS - 1):
        below = step @ (below * weights)
    return 1.0 - float(below @ weights)


def test_it_agrees_with_the_walk(walkers: Batch) -> None:
    levels, found = [3.5, 6.5, 9.5, 12.0, 14.0], []
    for seed in range(12):
        walkers.reset(seed=1 + COPIES * seed)
        found.append(walkers.split("w.x", levels, STEPS * 0.01, seed=seed))
    expected = of_walk(levels[-1])
    # The reflection principle of continuous time, with Siegmund's mean overshoot of 0.5826.
    assert expected == pytest.approx(2.0 * norm.sf(14.5826 / math.sqrt(STEPS)), rel=0.1)
    probabilities = np.array([one.probability for one in found])
    spread = float(np.mean([one.variation(COPIES) for one in found]))
    assert spread < 0.15  # plain sampling of as many copies: 1
    assert probabilities.mean() == pytest.approx(expected, rel=4.0 * spread / math.sqrt(12))
    assert probabilities.std() / expected < 2.0 * spread


def test_one_level_is_plain_sampling(walkers: Batch) -> None:
    walkers.reset(seed=7)
    share = float((walkers.record(STEPS, "w.x")[:, :, 0].max(axis=1) >= 5.0).mean())
    walkers.reset(seed=7)
    found = walkers.split("w.x", [5.0], STEPS * 0.01)
    assert found.probability == share


def test_copies_of_a_state_have_the_noise_of_their_seeds(walkers: Batch) -> None:
    walkers.reset(seed=3)
    walkers.step(5)
    saved, before = walkers.save(), walkers.get("w.x")
    zeros = np.zeros(COPIES, dtype=int)
    walkers.restore(saved, source=zeros, seed=50)
    assert (walkers.get("w.x") == before[0]).all()
    walkers.step(4)
    moved = walkers.get("w.x") - before[0]
    walkers.reset(seed=50)
    walkers.step(5)
    fresh = walkers.get("w.x")
    walkers.step(4)
    assert moved == pytest.approx(walkers.get("w.x") - fresh, abs=1e-12)  # sums of other numbers
    walkers.restore(saved, source=zeros)
    walkers.step(4)
    assert len(set(walkers.get("w.x").tolist())) == 1


def test_copies_outside_the_mask_stay(walkers: Batch) -> None:
    walkers.reset()
    going = np.arange(COPIES) % 2 == 0
    walkers.step(3, going)
    assert np.array_equal(walkers.time, np.where(going, 0.03, 0.0))


def test_mistakes_are_named(walkers: Batch) -> None:
    walkers.reset()
    with pytest.raises(InputError, match=r"split: levels must rise, found \[2\.0, 1\.0\]"):
        walkers.split("w.x", [2.0, 1.0], 0.1)
    never = walkers.split("w.x", [1e6], 0.1)
    assert not never.is_reached
    assert never.variation(COPIES) == float("inf")
