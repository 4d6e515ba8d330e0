"""A native FMU of FMI 3.0 in FMPy, with the calls of one of FMI 2.0: scalars by their references."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi3 import FMU3Slave

ELEMENTS = 20
"""Bits of a value reference below those that say how many elements follow the first."""


class Slave3:
    """An FMU in FMPy, with its messages; it is its own ``fmu``."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(path), validate=True)
        unzipped = folder / path.stem
        fmpy.extract(str(path), str(unzipped))
        self.messages: list[str] = []
        self.fmu3 = FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=str(unzipped),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="x",
        )
        self.fmu3.instantiate(
            logMessage=lambda _e, _s, _c, text: self.messages.append(text.decode())
        )
        self.fmu = self
        self.whole: dict[int, tuple[Any, list[int]]] = {}
        """By scalar: its variable, and all scalars of that."""
        self.values: dict[int, Any] = {}
        """Start values, and what was set, by scalar."""
        for variable in self.description.modelVariables:
            first = variable.valueReference & (1 << ELEMENTS) - 1
            size = (variable.valueReference >> ELEMENTS) + 1
            assert size == (variable.dimensions[0].start if variable.dimensions else 1)
            scalars = list(range(first, first + size))
            self.whole |= dict.fromkeys(scalars, (variable, scalars))
            if isinstance(variable.start, str | list):
                starts = variable.start if isinstance(variable.start, list) else [variable.start]
                starts = (
                    starts[0].split() if variable.type != "String" and len(starts) == 1 else starts
                )
                self.values |= dict(zip(scalars, map(_parsed, starts), strict=True))

    def begin(self) -> None:
        self.fmu3.enterInitializationMode(startTime=0.0)
        self.fmu3.exitInitializationMode()

    def _set(self, put: Any, references: Sequence[int], values: Sequence[Any]) -> None:
        self.values |= dict(zip(references, values, strict=True))
        variables = {id(v): (v, all_) for v, all_ in map(self.whole.__getitem__, references)}
        given = [self.values[r] for _, scalars in variables.values() for r in scalars]
        put([v.valueReference for v, _ in variables.values()], given)

    def _get(self, get: Any, references: Sequence[int]) -> list[Any]:
        variables = {id(v): (v, all_) for v, all_ in map(self.whole.__getitem__, references)}
        scalars = [r for _, all_ in variables.values() for r in all_]
        found = get([v.valueReference for v, _ in variables.values()], len(scalars))
        by_scalar = dict(zip(scalars, found, strict=True))
        return [by_scalar[r] for r in references]

    def setReal(self, references: Sequence[int], values: Sequence[float]) -> None:
        self._set(self.fmu3.setFloat64, references, values)

    def setInteger(self, references: Sequence[int], values: Sequence[int]) -> None:
        self._set(self.fmu3.setInt32, references, values)

    def setBoolean(self, references: Sequence[int], values: Sequence[bool]) -> None:
        self._set(self.fmu3.setBoolean, references, values)

    def setString(self, references: Sequence[int], values: Sequence[str]) -> None:
        self._set(self.fmu3.setString, references, values)

    def getReal(self, references: Sequence[int]) -> list[float]:
        return self._get(self.fmu3.getFloat64, references)

    def getInteger(self, references: Sequence[int]) -> list[int]:
        return self._get(self.fmu3.getInt32, references)

    def getBoolean(self, references: Sequence[int]) -> list[bool]:
        return self._get(self.fmu3.getBoolean, references)

    def doStep(self, t: float, h: float) -> None:
        assert self.fmu3.doStep(t, h) == (False, False, False, t + h)

    def serialized(self) -> bytes:
        """Return the whole state as bytes."""
        state = self.fmu3.getFMUState()
        saved: bytes = self.fmu3.serializeFMUState(state)
        self.fmu3.freeFMUState(state)
        return saved

    def restore(self, saved: bytes) -> None:
        """Go back to a state of bytes."""
        state = self.fmu3.deserializeFMUState(saved)
        self.fmu3.setFMUState(state)
        self.fmu3.freeFMUState(state)


def _parsed(text: str) -> Any:
    if text in ("true", "false"):
        return text == "true"
    try:
        return float(text) if "." in text or "e" in text else int(text)
    except ValueError:
        return text
