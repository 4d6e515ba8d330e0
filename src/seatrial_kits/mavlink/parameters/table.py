"""The parameters of a vehicle: their values, and where these are kept."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError

from ..settings import Settings
from .definition import Definition
from .file import ParameterFile


@dataclass(frozen=True)
class Refusal:
    """Refusal of a parameter, with its reason."""

    error: int
    """MAV_PARAM_ERROR."""
    reason: str


class ParameterTable:
    """Parameters by name, each with an index that stays what it is.

    Values are those of ``definitions``, then those of ``file``, then what `put` is given, and
    passed on to ``settings``. Raises InputError for two definitions of one name, and for what
    in the file does not fit.
    """

    def __init__(
        self,
        definitions: Iterable[Definition],
        settings: Settings,
        file: ParameterFile | None = None,
    ) -> None:
        self._definitions: dict[str, Definition] = {}
        for definition in definitions:
            if definition.name in self._definitions:
                raise InputError(f"parameter {definition.name} is defined twice")
            self._definitions[definition.name] = definition
        self.names: Sequence[str] = tuple(self._definitions)
        self._indices = {name: index for index, name in enumerate(self.names)}
        self._values = {name: d.default for name, d in self._definitions.items()}
        self._settings, self._file = settings, file
        self._kept = {} if file is None else file.read(self._checked)
        for name, value in self._kept.items():
            self._take(name, value)

    def __contains__(self, name: str) -> bool:
        return name in self._definitions

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def index(self, name: str) -> int:
        """Return the index of a parameter."""
        return self._indices[name]

    def kind(self, name: str) -> int:
        """Return the MAV_PARAM_TYPE of a parameter."""
        return self._definitions[name].kind

    def default(self, name: str) -> float:
        """Return what a parameter starts with if nothing sets it."""
        return self._definitions[name].default

    def put(self, name: str, value: float) -> Refusal | None:
        """Set a parameter, which acts at once and is in the file when this returns.

        Returns why not, and leaves it as it is, if it cannot be set to that value.
        """
        definition = self._definitions[name]
        if definition.fixed:
            return Refusal(mavlink.MAV_PARAM_ERROR_READ_ONLY, definition.fixed)
        taken = definition.accepted(value)
        if taken is None:
            reason = f"{definition.allowed} is allowed"
            return Refusal(mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, reason)
        kept = self._kept if definition.passing else {**self._kept, name: taken}
        if self._file is not None and kept != self._kept:
            try:
                self._file.write(kept)
            except OSError as error:
                reason = f"its file cannot be written: {error.strerror}"
                return Refusal(mavlink.MAV_PARAM_ERROR_PERMISSION_DENIED, reason)
        self._kept = kept
        self._take(name, taken)
        return None

    def _take(self, name: str, value: float) -> None:
        self._values[name] = value
        apply = self._definitions[name].apply
        if apply is not None:
            apply(self._settings, value)

    def _checked(self, name: str, value: float) -> float:
        """Return a value of the file as it is taken; raise InputError if it does not fit."""
        if name not in self._definitions:
            raise InputError(f"this vehicle has no parameter {name}")
        definition = self._definitions[name]
        if definition.fixed or definition.passing:
            raise InputError(f"{name} cannot be set: {definition.fixed or definition.passing}")
        taken = definition.accepted(value)
        if taken is None:
            raise InputError(f"{name} is {value:g}, {definition.allowed} is allowed")
        return taken
