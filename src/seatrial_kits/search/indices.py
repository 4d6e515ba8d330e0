"""Sensitivity indices of a function of the unit cube: Sobol's and Morris's, by SALib."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .searching import needed

Outputs = Callable[[np.ndarray], np.ndarray]
"""Of points, a row each: a row of outputs for each."""
_LEVELS = 4
_CONFIDENCE = 0.95


@dataclass(frozen=True)
class Sobol:
    """Indices of one output, of each key, with half-widths of their 95 % intervals."""

    first: np.ndarray
    first_half: np.ndarray
    total: np.ndarray
    total_half: np.ndarray


@dataclass(frozen=True)
class Morris:
    """Elementary effects of one output, of each key: per whole range, in the output's unit."""

    mu_star: np.ndarray
    mu_star_half: np.ndarray
    sigma: np.ndarray


def sobol(outputs: Outputs, keys: int, samples: int, seed: int) -> list[Sobol]:
    """Return the indices of each output, from ``samples`` (keys + 2) runs.

    First order: the share of the variance that goes with the key alone; total: with it and
    whatever it interacts with. Saltelli's sampling of Sobol's sequence, estimators of Saltelli et
    al. (2010, Variance based sensitivity analysis of model output), intervals by bootstrap. Points
    are independent probabilities of the keys. An output that does not vary has nan. Raises
    InputError if SALib is not installed.
    """
    sampling, analysis = needed("SALib.sample.sobol"), needed("SALib.analyze.sobol")
    problem = _problem(keys)
    points = sampling.sample(problem, samples, calc_second_order=False, seed=_seed(seed, 1))
    return [_sobol(analysis, problem, column, _seed(seed, 2)) for column in outputs(points).T]


def morris(outputs: Outputs, keys: int, trajectories: int, seed: int) -> list[Morris]:
    """Return the effects on each output, from ``trajectories`` (keys + 1) runs.

    mu* is the mean size of the effect of a key, sigma its standard deviation: large where the
    effect depends on the other keys or is not linear ([Morris1991]; [Campolongo2007]). Points
    are shares of the ranges, on four levels. Raises InputError if SALib is not installed.
    """
    sampling, analysis = needed("SALib.sample.morris"), needed("SALib.analyze.morris")
    problem = _problem(keys)
    points = sampling.sample(problem, trajectories, num_levels=_LEVELS, seed=_seed(seed, 3))
    found = []
    for column in outputs(points).T:
        result = analysis.analyze(
            problem, points, column, conf_level=_CONFIDENCE, num_levels=_LEVELS, seed=_seed(seed, 4)
        )
        names = ("mu_star", "mu_star_conf", "sigma")
        found.append(Morris(*(np.asarray(result[name], float) for name in names)))
    return found


def _sobol(analysis: Any, problem: dict[str, Any], column: np.ndarray, seed: int) -> Sobol:
    if not np.ptp(column) > 0.0:
        none = np.full(problem["num_vars"], np.nan)
        return Sobol(none, none, none, none)
    result = analysis.analyze(
        problem, column, calc_second_order=False, conf_level=_CONFIDENCE, seed=seed
    )
    return Sobol(*(np.asarray(result[name], float) for name in ("S1", "S1_conf", "ST", "ST_conf")))


def _problem(keys: int) -> dict[str, Any]:
    names = [f"x{i}" for i in range(keys)]
    return {"num_vars": keys, "names": names, "bounds": [[0.0, 1.0]] * keys}


def _seed(seed: int, which: int) -> int:
    """Return a seed of its own for each use, none of which is that of another question's seed."""
    [state] = np.random.SeedSequence([seed, which]).generate_state(1).tolist()
    return int(state)
