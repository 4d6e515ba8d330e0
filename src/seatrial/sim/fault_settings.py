"""Settings of a fault, in the units of what it acts on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import InputError
from ..fmi.instance import Variable
from ..model.component import NS
from ..model.faults.catalogue import kinds
from ..model.units import quantity
from ..system.fault_entry import FaultEntry
from ..system.references.values import from_written
from ..system.rig import duration_ns


class Settings:
    """What an entry says of the scalars of one port. All raise InputError, naming ``origin``."""

    def __init__(
        self,
        entry: FaultEntry,
        scalars: Sequence[Variable],
        origin: str,
        presets: Mapping[str, Any],
    ) -> None:
        self.entry = entry
        self._scalars, self._origin, self._presets = scalars, origin, presets

    def refused(self, key: str, why: str) -> InputError:
        """Return the error that a setting does not fit."""
        return InputError(f"{self._origin}.{key}: {why}")

    def exactly(self, key: str, index: int) -> Any:
        """Return a value of a scalar's own type: a number, a text, a truth value, a preset."""
        port = self._scalars[0].name.partition(".")[0]
        given = from_written(
            self._written(key), self._scalars, self._presets.get(port, {}), f"{self._origin}.{key}"
        )
        return given[self._scalars[index].name].value

    def level(self, key: str, index: int) -> float:
        """Return a number in a scalar's unit."""
        variable = self._scalars[index]
        return self._quantity(key, self._of_axis(key, index), variable.measure)

    def rate(self, key: str, index: int, *, positive: bool = False) -> float:
        """Return a number in a scalar's unit per second."""
        unit = self._scalars[index].unit
        per_second = f"{unit}/s" if unit not in ("", "1") else "1/s"
        found = self._quantity(key, self._of_axis(key, index), per_second)
        if positive and found <= 0.0:
            raise self.refused(key, f"it must be above 0, found {found!r}")
        return found

    def ends(self, index: int) -> tuple[float, float]:
        """Return the ends of a range, in a scalar's unit."""
        low, high = self.level("low", index), self.level("high", index)
        if low > high:
            raise self.refused("low", f"it is above `high`: {low!r} > {high!r}")
        return low, high

    def number(self, key: str) -> float:
        """Return a number without a unit."""
        return self._quantity(key, self._written(key), "1")

    def probability(self) -> float:
        """Return the probability."""
        default = kinds()[self.entry.what].settings["probability"].default
        if self.entry.probability is None and default is not None:
            return default
        found = self.number("probability")
        if not 0.0 <= found <= 1.0:
            raise self.refused("probability", f"it is from 0 to 1, found {found!r}")
        return found

    def duration(self, key: str, default_ns: int | None = None) -> int:
        """Return a time in ns, above 0 if there is no default."""
        if getattr(self.entry, key) is None and default_ns is not None:
            return default_ns
        written = self._written(key)
        found = duration_ns(str(written), f"{self._origin}.{key}")
        if found < 0 or (found == 0 and default_ns is None):
            raise self.refused(key, f"a time above 0 is needed, found {written!r}")
        return found

    def every(self) -> int:
        """Return how often new numbers come, ns."""
        default = kinds()[self.entry.what].settings["every"].default or 0.0
        return self.duration("every", round(default * NS))

    def coefficients(self) -> tuple[float, ...]:
        """Return the five coefficients of a deviation, in the unit of the scalars."""
        written = self._written("coefficients")
        if not isinstance(written, list) or len(written) != 5:
            raise self.refused("coefficients", f"five of them are needed, found {written!r}")
        measure = self._scalars[0].measure
        return tuple(self._quantity("coefficients", each, measure) for each in written)

    def range(self) -> tuple[float, float] | None:
        """Return the range of an angle, None if none is written."""
        written = self.entry.wraps
        if written is None:
            return None
        if not isinstance(written, list) or len(written) != 2:
            raise self.refused("wraps", f"two ends of a range are needed, found {written!r}")
        measure = self._scalars[0].measure
        low, high = (self._quantity("wraps", each, measure) for each in written)
        if not low < high:
            raise self.refused("wraps", f"the first must be below the second, found {written!r}")
        return low, high

    def numbers(self) -> dict[str, list[float]]:
        """Return all settings as numbers, one for each scalar, as a device takes them."""
        found, count = {}, range(len(self._scalars))
        for key, setting in kinds()[self.entry.what].settings.items():
            if key in ("every", "wraps"):
                if getattr(self.entry, key) is not None:
                    raise self.refused(key, "a sensor has its own: leave it out")
            elif setting.measure == "value":
                found[key] = [self.level(key, index) for index in count]
            elif setting.measure == "rate":
                found[key] = [self.rate(key, index) for index in count]
            elif setting.measure == "coefficients":
                found[key] = list(self.coefficients())
            else:
                found[key] = [self.number(key)]
        return found

    def _written(self, key: str) -> Any:
        written = getattr(self.entry, key)
        if written is None:
            raise self.refused(key, f"{self.entry.what} needs it")
        return written

    def _of_axis(self, key: str, index: int) -> Any:
        """Return what is written for one scalar."""
        written = self._written(key)
        if not isinstance(written, list):
            return written
        if len(written) != len(self._scalars):
            names = ", ".join(v.name for v in self._scalars)
            raise self.refused(
                key, f"{len(self._scalars)} values are needed ({names}), found {len(written)}"
            )
        return written[index]

    def _quantity(self, key: str, written: Any, measure: Any) -> float:
        try:
            return quantity(written, measure)
        except InputError as error:
            raise self.refused(key, str(error)) from None
