"""Check of a plant's mass matrix."""

from __future__ import annotations

import numpy as np

from ...errors import InputError
from ...model.expressions import Vector


def require_positive_definite(craft: str, M: Vector, parameters: str) -> None:
    """Raise InputError if the mass matrix M is not positive definite.

    ``craft`` and ``parameters`` name, in the message, whose it is and what it is made of.
    """
    smallest = np.linalg.eigvalsh(M).min()
    if smallest <= 0.0:
        raise InputError(
            f"{craft}: the mass matrix is not positive definite (smallest eigenvalue "
            f"{smallest:.4g}); check {parameters}"
        )
