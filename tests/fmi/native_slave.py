"""A native FMU in FMPy."""

from __future__ import annotations

import ctypes
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE


class Slave:
    """An FMU in FMPy, with its messages."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(path))
        unzipped = folder / path.stem
        fmpy.extract(str(path), str(unzipped))
        self.messages: list[str] = []
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(unzipped),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="x",
        )
        self.callbacks = fmi2CallbackFunctions()
        # FMPy's own logger is a C function with the arguments that a printf takes.
        log = ctypes.CFUNCTYPE(
            None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p,
            ctypes.c_char_p, ctypes.c_char_p,
        )  # fmt: skip
        self.log = log(lambda _e, _n, _s, _c, _f, text: self.messages.append(text.decode()))
        self.callbacks.logger = ctypes.cast(self.log, fmi2CallbackLoggerTYPE)
        self.fmu.instantiate(callbacks=self.callbacks)
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}

    def begin(self) -> None:
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def serialized(self) -> bytes:
        """Return the whole state as bytes."""
        state = self.fmu.getFMUstate()
        saved: bytes = self.fmu.serializeFMUstate(state)
        self.fmu.freeFMUstate(state)
        return saved

    def restore(self, saved: bytes) -> None:
        """Go back to a state of bytes."""
        state = self.fmu.deSerializeFMUstate(saved)
        self.fmu.setFMUstate(state)
        self.fmu.freeFMUstate(state)
