"""Dense layers of networks: products with constant matrices, summed in one order everywhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Dense:
    """Weights W, a row for each output, and offsets b, of a dense layer y = W x + b."""

    def __init__(self, weights: ArrayLike, offsets: ArrayLike) -> None:
        self.weights: NDArray[np.float64] = np.array(weights, dtype=np.float64)
        self.offsets: NDArray[np.float64] = np.array(offsets, dtype=np.float64)
        self.columns: NDArray[np.float64] = np.ascontiguousarray(self.weights.T)


def dense(layer: Dense, values: Sequence[float]) -> list[float]:
    """Return W x + b, each element as ((b + w_1 x_1) + w_2 x_2) + ... in doubles.

    The order is part of the result: native FMUs add in it too.
    """
    terms = np.empty((len(values) + 1, len(layer.offsets)))
    terms[0] = layer.offsets
    with np.errstate(over="ignore", invalid="ignore"):  # the component refuses what is not finite
        np.multiply(layer.columns, np.array(values)[:, None], out=terms[1:])
        # A reduction may add in pairs, an accumulation may not.
        found: list[float] = np.add.accumulate(terms, axis=0)[-1].tolist()
    return found
