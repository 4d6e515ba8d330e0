"""Recorded signals: arrays by name, and as a table of pandas or xarray."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, unknown
from .arrays import SignalArray

if TYPE_CHECKING:
    import pandas
    import xarray


class UnknownSignalError(InputError, KeyError):
    """A mapping of signals has no signal of that name."""

    __str__ = Exception.__str__  # KeyError shows the repr of its argument


class Signals(Mapping[str, SignalArray]):
    """Signals by name, ``component.port``: read-only arrays with one row per recorded time.

    ``signals["hull.position.x"]`` has the shape (rows,), ``signals["hull.position"]`` (rows, 3):
    a whole port, its elements in the order of the record. Values are in the unit of the port
    (SI, angles in radians), which ``signals[name].unit`` says. Real signals are float64, Integer
    ones int64, Booleans bool, text is of the type object. Iteration is over scalars.

    Raises InputError, which is a KeyError here, for a name that was not recorded.
    """

    def __init__(
        self, names: list[str], t: SignalArray, column: Callable[[str], SignalArray]
    ) -> None:
        self._names, self._column = dict.fromkeys(names), column
        self._found: dict[str, SignalArray] = {}
        self.t = _frozen(t)
        """Simulated time of each row, s."""

    def __getitem__(self, name: str) -> SignalArray:
        if name not in self._found:
            self._found[name] = _frozen(self._array(name))
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<{len(self)} signals, {len(self.t)} rows>"

    @property
    def units(self) -> dict[str, str]:
        """Unit of each signal, by name."""
        return {name: self[name].unit for name in self}

    def to_pandas(self) -> pandas.DataFrame:
        """Return a table with a column per scalar signal, indexed by time in s.

        ``table.attrs["units"]`` has the units by name. Raises InputError if pandas is not
        installed.
        """
        library = needed("pandas", "to_pandas")
        index = library.Index(np.array(self.t), name="time")
        table: pandas.DataFrame = library.DataFrame(
            {name: np.array(self[name]) for name in self}, index=index
        )
        table.attrs["units"] = self.units
        return table

    def to_xarray(self) -> xarray.Dataset:
        """Return a dataset with a variable per scalar signal along ``time`` (s).

        Attributes ``units`` and ``long_name`` are those of the CF conventions. Raises InputError
        if xarray is not installed.
        """
        library = needed("xarray", "to_xarray")
        columns = {name: ("time", np.array(self[name]), _attributes(self[name])) for name in self}
        times = ("time", np.array(self.t), _attributes(self.t))
        dataset: xarray.Dataset = library.Dataset(columns, coords={"time": times})
        return dataset

    def _array(self, name: str) -> SignalArray:
        if name in self._names:
            return self._column(name)
        elements = [n for n in self._names if n.startswith((f"{name}.", f"{name}["))]
        if "." not in name or not elements:
            ports = {n.rpartition(".")[0] for n in self._names if n.count(".") > 1}
            raise UnknownSignalError(unknown("signal", name, [*self._names, *ports]))
        columns = [self[element] for element in elements]
        units = list(dict.fromkeys(column.unit for column in columns))
        unit = units[0] if len(units) == 1 else ", ".join(column.unit for column in columns)
        return SignalArray(np.stack(columns, axis=1), unit, columns[0].description)


def needed(module: str, method: str) -> Any:
    """Return an optional library. Raises InputError, with the command that installs it."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(f"{method} needs {module}: pip install {module}") from None


def _frozen(array: SignalArray) -> SignalArray:
    array.flags.writeable = False
    return array


def _attributes(array: SignalArray) -> dict[str, str]:
    attributes = {"units": array.unit, "long_name": array.description}
    return {key: text for key, text in attributes.items() if text}
