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
_WIDE, _NARROW = 0.3, 0.05
"""Standard deviations that CMA-ES begins with, as shares of the ranges; narrow near an optimum."""


def search(
    method: Method, value: Value, start: np.ndarray, runs: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return all points that were looked at for the least value, and their values.

    ``cma-es`` is the covariance matrix adaptation of Hansen (2016, The CMA evolution strategy: a
    tutorial) from ``start``; where it has converged it begins anew at a random point with twice as
    many points a generation ([Auger2005]), until all runs are used. ``bayesian`` is
    Optuna's multivariate tree-structured Parzen estimator ([Bergstra2011]). Raises InputError
    if the library is not installed.
    """
    looked = _Looked(value, start)
    if method == "cma-es":
        _evolved(looked, start, runs - 1, seed, _WIDE)
    else:
        _estimated(looked, runs - 1, seed)
    return looked.points, looked.values


def search_refined(
    value: Value, start: np.ndarray, runs: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return points and values as `search` does, for few runs of a value that has one optimum.

    Half of the runs are the estimator's, which knows the value at ``start``; CMA-ES goes on from
    the best of them, in small steps.
    """
    looked = _Looked(value, start)
    _estimated(looked, runs // 2 - 1, seed)
    best = looked.points[int(np.argmin(looked.values))]
    _evolved(looked, best, runs - runs // 2, seed, _NARROW)
    return looked.points, looked.values


def search_front(
    value: Value, start: np.ndarray, runs: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return points and values as `search` does, for the least of several values at once.

    ``value`` has a column for each. The search is Optuna's of several objectives (Ozaki et al.,
    Multiobjective tree-structured Parzen estimator, 2022), which knows the values at ``start``.
    """
    looked = _Looked(value, start)
    _estimated(looked, runs - 1, seed)
    return looked.points, looked.values


class _Looked:
    """Values that are looked at, and all points so far with theirs; the first is the start."""

    def __init__(self, value: Value, start: np.ndarray) -> None:
        self._value, self.points = value, start[None]
        self.values = value(start[None])

    def __call__(self, batch: np.ndarray) -> np.ndarray:
        found = self._value(batch)
        self.points = np.vstack([self.points, batch])
        self.values = np.concatenate([self.values, found])
        return found


def _evolved(looked: _Looked, start: np.ndarray, runs: int, seed: int, step: float) -> None:
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
            strategy = cma.CMAEvolutionStrategy(start, step, options)
            while runs > 0 and not strategy.stop():
                asked = np.array(strategy.ask())
                found = looked(asked[:runs, :dimensions])
                runs -= len(found)
                if len(found) == len(asked):
                    strategy.tell(list(asked), found.tolist())
        start, size = random.random(len(start)), 2 * size


def _estimated(looked: _Looked, runs: int, seed: int) -> None:
    optuna: Any = needed("optuna")
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # options that may change
        sampler = optuna.samplers.TPESampler(
            seed=seed, multivariate=True, constant_liar=True, n_startup_trials=2 * _BATCH
        )
    first = np.atleast_1d(looked.values[0]).tolist()
    study = optuna.create_study(sampler=sampler, directions=["minimize"] * len(first))
    names = [f"x{i}" for i in range(looked.points.shape[1])]
    ranges = {name: optuna.distributions.FloatDistribution(0.0, 1.0) for name in names}
    known = dict(zip(names, looked.points[0].tolist(), strict=True))
    study.add_trial(optuna.trial.create_trial(params=known, distributions=ranges, values=first))
    while runs > 0:
        trials = [study.ask(ranges) for _ in range(min(_BATCH, runs))]
        found = looked(np.array([[trial.params[name] for name in names] for trial in trials]))
        for trial, each in zip(trials, found, strict=True):
            study.tell(trial, np.atleast_1d(each).tolist())
        runs -= len(trials)
