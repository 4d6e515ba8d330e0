"""A Gaussian process of robustness over the unit cube, that says how sure it is."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from .searching import needed

_LENGTHS, _VARIANCES, _NOISES = (0.03, 30.0), (1e-3, 1e3), (1e-8, 1e-1)
"""Limits of what is fitted; lengths as shares of the ranges."""


class Surrogate:
    """Gaussian process of values as `_levelled`: Matérn's covariance, with a length per key.

    Lengths and variance are those of the greatest likelihood ([Rasmussen2006],
    Gaussian Processes for Machine Learning, section 5.4). ``scale`` is a size of the values.
    Of two processes, that of the values (order 5/2) and one of their signs alone (order 3/2, which
    suits a jump from passing to failing), it is the one that mistakes fewer runs when they are left
    out. Raises InputError if scikit-learn is not installed.
    """

    def __init__(self, dimensions: int, scale: float) -> None:
        gp = needed("sklearn.gaussian_process")
        kernels = needed("sklearn.gaussian_process.kernels")
        self._scale = scale

        def process(order: float) -> Any:
            shape = kernels.Matern(np.full(dimensions, 0.4), _LENGTHS, nu=order)
            kernel = kernels.ConstantKernel(1.0, _VARIANCES) * shape
            return gp.GaussianProcessRegressor(kernel + kernels.WhiteKernel(1e-5, _NOISES))

        self._of_values, self._of_signs = process(2.5), process(1.5)
        self._process: Any = self._of_values

    def fit(self, points: np.ndarray, values: np.ndarray) -> None:
        """Fit it to all values so far; the search for lengths begins at those of before."""
        levelled = np.arcsinh(values / self._scale)
        signs = np.where(values > 0, 1.0, -1.0)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a length at its bound: a key that does not matter
            for process, goal in ((self._of_values, levelled), (self._of_signs, signs)):
                process.kernel = getattr(process, "kernel_", process.kernel)
                process.fit(points, goal)
        both = (self._of_values, self._of_signs)
        mistakes = [((_left_out(p) > 0) != (values > 0)).sum() for p in both]
        self._process = both[int(np.argmin(mistakes))]

    def left_out(self) -> np.ndarray:
        """Return the mean at each run as all others say it."""
        return _left_out(self._process)

    def at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return mean and standard deviation at points; the mean's sign is that of the value."""
        process = self._process
        kernel = process.kernel_.k1  # without what is noise
        across = kernel(points, process.X_train_)
        half = np.linalg.solve(process.L_, across.T)
        variance = kernel.diag(points) - np.einsum("ij,ij->j", half, half)
        return across @ process.alpha_, np.sqrt(np.maximum(variance, 1e-12))

    def covariance(self, points: np.ndarray) -> np.ndarray:
        """Return the covariance at points, as it is after the runs."""
        process = self._process
        kernel = process.kernel_.k1
        half = np.linalg.solve(process.L_, kernel(points, process.X_train_).T)
        covariance: np.ndarray = kernel(points) - half.T @ half
        return covariance


def _left_out(process: Any) -> np.ndarray:
    """Return means of runs left out one at a time, in closed form (ibid., equation 5.12)."""
    inverse = np.linalg.inv(process.L_)
    left: np.ndarray = process.y_train_ - process.alpha_ / (inverse**2).sum(axis=0)
    return left
