"""Arrays of one signal, with its unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


class SignalArray(np.ndarray[Any, np.dtype[Any]]):
    """A NumPy array with the ``unit`` and ``description`` of its signal, for every row its value.

    Slices and copies keep both; what is computed from it is a plain array, because a product or
    a sine has another unit.
    """

    unit: str
    """As FMI writes it: ``m/s``, ``rad``, ``1``; empty for text and Booleans."""
    description: str

    def __new__(cls, values: Any, unit: str = "", description: str = "") -> SignalArray:
        """Return ``values`` with a unit."""
        array = np.asarray(values).view(cls)
        array.unit, array.description = unit, description
        return array

    def __array_finalize__(self, source: Any) -> None:
        self.unit = getattr(source, "unit", "")
        self.description = getattr(source, "description", "")

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        if "out" in options:
            options["out"] = tuple(_bare(array) for array in options["out"])
        return getattr(ufunc, method)(*(_bare(value) for value in inputs), **options)

    def __array_function__(
        self, function: Any, types: Any, arguments: Iterable[Any], options: Mapping[str, Any]
    ) -> Any:
        found = super().__array_function__(function, types, arguments, options)
        if isinstance(found, (list, tuple)):
            return type(found)(_bare(element) for element in found)
        return _bare(found)

    def __reduce__(self) -> Any:
        return SignalArray, (_bare(self), self.unit, self.description)


def _bare(value: Any) -> Any:
    return value.view(np.ndarray) if isinstance(value, SignalArray) else value
