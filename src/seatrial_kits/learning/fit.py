"""Small networks fitted to rows of numbers, outside of any run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from .network import Array

_MEMORY = 20
"""Corrections that L-BFGS keeps."""


def fitted(
    x: Array, y: Array, hidden: Sequence[int], *, decay: float, iterations: int, seed: int
) -> dict[str, Any]:
    """Return the arrays of ``network_npz`` of a network that gives rows ``y`` for rows ``x``.

    Layers of ``hidden`` neurons with tanh, then a linear one. With every column of both scaled to
    mean 0 and deviation 1, and all weights and offsets w, L-BFGS-B (SciPy) makes

        (sum |network(x) - y|^2 + decay |w|^2) / (2 rows)

    small, in ``iterations`` at most; it begins from weights drawn by ``seed``, uniform in
    +-sqrt(6 / (columns + rows of W)) (X. Glorot and Y. Bengio 2010), and offsets 0. The outputs are
    limited to the extremes of ``y``.
    """
    from scipy.optimize import minimize  # takes longer to import than a network to read

    x_mean, x_scale, scaled_x = _scaled(x)
    y_mean, y_scale, scaled_y = _scaled(y)
    shapes = [(b, a) for a, b in pairwise([x.shape[1], *hidden, y.shape[1]])]
    found = minimize(
        _cost,
        _drawn(shapes, seed),
        (scaled_x, scaled_y, shapes, decay),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": iterations, "maxcor": _MEMORY, "maxfun": 10 * iterations},
    )
    arrays: dict[str, Any] = {"activations": ["tanh"] * len(hidden) + ["identity"]}
    for number, (weights, offsets) in enumerate(_layers(found.x, shapes)):
        arrays |= {f"W{number}": weights, f"b{number}": offsets}
    return arrays | {
        "input_mean": x_mean,
        "input_scale": x_scale,
        "output_mean": y_mean,
        "output_scale": y_scale,
        "output_low": y.min(axis=0),
        "output_high": y.max(axis=0),
    }


def answers(arrays: Mapping[str, Any], x: Array) -> Array:
    """Return what a network of `fitted` gives for each row of ``x``, within its output's range."""
    values = (x - arrays["input_mean"]) / arrays["input_scale"]
    for number, kind in enumerate(arrays["activations"]):
        values = values @ arrays[f"W{number}"].T + arrays[f"b{number}"]
        values = np.tanh(values) if kind == "tanh" else values
    values = values * arrays["output_scale"] + arrays["output_mean"]
    found: Array = np.clip(values, arrays["output_low"], arrays["output_high"])
    return found


def _scaled(rows: Array) -> tuple[Array, Array, Array]:
    """Return means, deviations (1 of a column that rests) and the scaled rows."""
    mean, deviation = rows.mean(axis=0), rows.std(axis=0)
    deviation[deviation == 0.0] = 1.0
    return mean, deviation, (rows - mean) / deviation


def _drawn(shapes: Sequence[tuple[int, int]], seed: int) -> Array:
    random = np.random.default_rng(seed)
    parts = [
        part
        for rows, columns in shapes
        for part in (
            random.uniform(-1.0, 1.0, rows * columns) * np.sqrt(6.0 / (rows + columns)),
            np.zeros(rows),
        )
    ]
    return np.concatenate(parts)


def _layers(w: Array, shapes: Sequence[tuple[int, int]]) -> list[tuple[Array, Array]]:
    """Return weights and offsets of each layer, of all in one row."""
    found, start = [], 0
    for rows, columns in shapes:
        middle, end = start + rows * columns, start + rows * (columns + 1)
        found.append((w[start:middle].reshape(rows, columns), w[middle:end]))
        start = end
    return found


def _cost(
    w: Array, x: Array, y: Array, shapes: Sequence[tuple[int, int]], decay: float
) -> tuple[float, Array]:
    """Return what `fitted` makes small, and its gradient by backpropagation."""
    layers, values = _layers(w, shapes), [x]
    for weights, offsets in layers[:-1]:
        values.append(np.tanh(values[-1] @ weights.T + offsets))
    weights, offsets = layers[-1]
    error = values[-1] @ weights.T + offsets - y
    slopes, slope = [], error
    for (weights, _), before in zip(reversed(layers), reversed(values), strict=True):
        slopes.append(np.concatenate([(slope.T @ before).ravel(), slope.sum(axis=0)]))
        slope = (slope @ weights) * (1.0 - before * before)
    gradient = np.concatenate(slopes[::-1]) + decay * w
    return float(np.sum(error * error) + decay * np.sum(w * w)) / (2 * len(x)), gradient / len(x)
