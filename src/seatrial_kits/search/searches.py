"""Searches for the least value over the unit cube, batch by batch: CMA-ES and Bayesian."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from .searching import needed

Method = Literal["cma-es", "bayesian"]
Value = Callable[[np.ndarray], np.ndarray]
"""Of points, a row each in shares of the ranges: a number for each."""
_BATCH = 8
_STEP = 0.3
"""Standard deviation that CMA-ES begins with, as a share of the ranges."""


def search(
    method: Method, value: Value, start: np.ndarray, runs: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return all points that were looked at for the least value, and their values.

    ``cma-es`` is the covariance matrix adaptation of Hansen (2016, The CMA evolution strategy: a
    tutorial) from ``start``; where it has converged it begins anew at a random point with twice as
    many points a generation (Auger and Hansen 2005), until all runs are used. ``bayesian`` is
    Optuna's multivariate tree-structured Parzen estimator (Bergstra et al. 2011). Raises InputError
    if the library is not installed.
    """
    points, values = np.array([start]), value(np.array([start]))

    def looked(batch: np.ndarray) -> np.ndarray:
        nonlocal points, values
        found = value(batch)
        points, values = np.vstack([points, batch]), np.append(values, found)
        return found

    by = _evolved if method == "cma-es" else _estimated
    by(looked, start, runs - 1, seed)
    return points, values


def _evolved(looked: Value, start: np.ndarray, runs: int, seed: int) -> None:
    cma = needed("cma")
    random = np.random.default_rng(seed)
    dimensions = len(start)
    start = np.append(
        start, [0.5] * (dimensions == 1)
    )  # CMA-ES needs two: the second plays no part
    size = max(_BATCH, 4 + int(3 * np.log(len(start))))
    while runs > 0:
        options = {
            "bounds": [0.0, 1.0],
            "popsize": size,
            "randn": lambda *shape: random.standard_normal(shape),
            "seed": np.nan,
            "tolfun": 1e-6,
            "tolx": 1e-5,
            "verbose": -9,
        }
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of one key: that there is nothing to adapt
            strategy = cma.CMAEvolutionStrategy(start, _STEP, options)
            while runs > 0 and not strategy.stop():
                asked = np.array(strategy.ask())
                found = looked(asked[:runs, :dimensions])
                runs -= len(found)
                if len(found) == len(asked):
                    strategy.tell(list(asked), found.tolist())
        start, size = random.random(len(start)), 2 * size


def _estimated(looked: Value, start: np.ndarray, runs: int, seed: int) -> None:
    optuna: Any = needed("optuna")
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # options that may change
        sampler = optuna.samplers.TPESampler(
            seed=seed, multivariate=True, constant_liar=True, n_startup_trials=2 * _BATCH
        )
    study = optuna.create_study(sampler=sampler)
    names = [f"x{i}" for i in range(len(start))]
    ranges = {name: optuna.distributions.FloatDistribution(0.0, 1.0) for name in names}
    while runs > 0:
        trials = [study.ask(ranges) for _ in range(min(_BATCH, runs))]
        found = looked(np.array([[trial.params[name] for name in names] for trial in trials]))
        for trial, each in zip(trials, found, strict=True):
            study.tell(trial, float(each))
        runs -= len(trials)
