"""Arrays of the sea models, and checks of the numbers that they are made of."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from ...errors import InputError

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Numbers = float | Array
"""A number, or an array of them."""

GRAVITY = 9.81
"""m/s2"""
WATER_DENSITY = 1025.0
"""kg/m3"""


def require_positive(**values: float) -> None:
    """Raise InputError for a value that is not a finite number above 0; names are keywords."""
    for name, value in values.items():
        if not 0.0 < value < math.inf:
            raise InputError(f"{name} is {value!r}, a number above 0 is needed")


def require_depth(depth: float) -> None:
    """Raise InputError for a depth of water that is not above 0; it may be infinite."""
    if not depth > 0.0:
        raise InputError(f"depth is {depth!r}, a number above 0 is needed; deep water is inf")


def fixed(values: npt.ArrayLike) -> Array:
    """Return a copy of ``values`` that cannot be written to."""
    array = np.array(values, dtype=float)
    array.flags.writeable = False
    return array
