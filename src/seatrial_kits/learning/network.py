"""Steps of a trained network, checked."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError, unknown

Array = NDArray[np.float64]

ALPHAS = {"leaky_relu": 0.01, "elu": 1.0}
"""Activations with a number below zero, and its value unless the file gives one: as PyTorch's."""
ACTIVATIONS = ("identity", "relu", "tanh", "sigmoid", "softplus", *ALPHAS)
LARGEST = 64 * 2**20
"""Bytes of a file."""
MOST = 2_000_000
"""Weights of a network: an FMU of it carries all as text."""
_WRITTEN = re.compile(r"(\w+)(?:\(([^()]*)\))?")


@dataclass
class Steps:
    """The steps of a network from its inputs on, as `policy.Network` takes them.

    Every number is finite, and every step fits the one before it: else InputError, which begins
    with ``where``.
    """

    inputs: int
    """How many numbers the network takes."""
    outputs: int = field(init=False)
    """How many numbers the last step gives."""
    steps: list[list[Any]] = field(default_factory=list)
    low: Array | None = None
    """Lowest values of the inputs in training, if the file has them; highest: ``high``."""
    high: Array | None = None

    def __post_init__(self) -> None:
        self.outputs = self.inputs

    def dense(self, weights: Array, offsets: Array, where: str) -> None:
        """Add y = W x + b."""
        rows, columns = finite(weights, where).shape
        if columns != self.outputs:
            raise InputError(
                f"{where}: weights for {columns} values, and {self.outputs} come in from before"
            )
        if finite(offsets, where).shape != (rows,):
            raise InputError(
                f"{where}: {rows} offsets are needed, one for each row of the weights, found "
                f"shape {offsets.shape}"
            )
        if rows * columns + sum(len(s[1]) * len(s[1][0]) for s in self._layers()) > MOST:
            raise InputError(f"{where}: more than {MOST} weights")
        self.steps.append(["dense", weights.tolist(), offsets.tolist()])
        self.outputs = rows

    def scale(self, factors: Array, offsets: Array, where: str) -> None:
        """Add y = factors x + offsets, each for itself."""
        for each in (factors, offsets):
            if finite(each, where).shape != (self.outputs,):
                raise InputError(
                    f"{where}: {self.outputs} numbers are needed, found shape {each.shape}"
                )
        if not factors.size or (np.all(factors == 1.0) and not np.any(offsets)):
            return
        layer = self.steps[-1] if self.steps else [""]
        if layer[0] == "dense" and not any(layer[2]) and np.all(factors == 1.0):
            layer[2] = offsets.tolist()  # MatMul and Add, the one layer that they are
        else:
            self.steps.append(["scale", factors.tolist(), offsets.tolist()])

    def clip(self, low: float, high: float, where: str) -> None:
        """Add limits."""
        if not low <= high:
            raise InputError(f"{where}: limits must rise, found {low!r} to {high!r}")
        self.steps.append(["clip", low, high])

    def activate(self, kind: str, alpha: float, where: str) -> None:
        """Add an activation of `ACTIVATIONS`."""
        if kind not in ACTIVATIONS:
            raise InputError(f"{where}: {unknown('activation', kind, ACTIVATIONS)}")
        if kind in ALPHAS:
            finite(np.array(alpha), where)
            self.steps.append([kind, alpha])
        elif kind != "identity":
            self.steps.append([kind])

    def activate_as(self, text: str, where: str) -> None:
        """Add an activation as a person writes it: ``tanh``, ``leaky_relu(0.2)``."""
        match = _WRITTEN.fullmatch(text.strip())
        kind = match[1] if match else text
        alpha = ALPHAS.get(kind, 0.0)
        if match and match[2] is not None:
            try:
                alpha = float(match[2])
            except ValueError:
                raise InputError(f"{where}: {text!r}: a number is needed in brackets") from None
            if kind in ACTIVATIONS and kind not in ALPHAS:
                raise InputError(f"{where}: {text!r}: {kind} has no number")
        self.activate(kind, alpha, where)

    def _layers(self) -> list[list[Any]]:
        return [step for step in self.steps if step[0] == "dense"]


def finite(values: Array, where: str) -> Array:
    """Return numbers. Raises InputError, with the place of the first, for one that is none."""
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        place = tuple(bad[0].tolist())
        raise InputError(f"{where}: {values[place]} at {list(place)}; finite numbers are needed")
    return values
