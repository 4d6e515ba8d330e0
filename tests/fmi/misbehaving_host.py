"""A host in FMPy that also does what FMI does not allow: FMU FOLDER OTHER [REFUSED].

It unpacks an FMU with a Real ``flow`` into ``level``, and with REFUSED calls it wrongly between steps. OTHER
is a file with a state of another FMU. The answers, messages and levels are printed as JSON.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

H = 0.01


class Host:
    """One instance, by the same calls for both versions of FMI."""

    def __init__(self, path: str, folder: str) -> None:
        self.description = fmpy.read_model_description(path)
        fmpy.extract(path, folder)
        self.is_3 = self.description.fmiVersion.startswith("3")
        self.answers: dict[str, tuple[str, list[str]]] = {}
        self.messages: list[str] = []
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.fmu: Any = (FMU3Slave if self.is_3 else FMU2Slave)(
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="x",
        )
        if self.is_3:
            self.fmu.instantiate(logMessage=lambda _e, _s, _c, text: self.take(text))
        else:
            self.fmu.instantiate(callbacks=self._callbacks())
        self.set, self.get = self._of("setReal", "setFloat64"), self._of("getReal", "getFloat64")
        self.save = self._of("getFMUstate", "getFMUState")
        self.restore = self._of("setFMUstate", "setFMUState")
        self.to_bytes = self._of("serializeFMUstate", "serializeFMUState")
        self.from_bytes = self._of("deSerializeFMUstate", "deserializeFMUState")

    def take(self, text: bytes) -> None:
        """Keep a message."""
        self.messages.append(text.decode())

    def _callbacks(self) -> Any:
        import ctypes

        from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

        pointer, text = ctypes.c_void_p, ctypes.c_char_p
        kind = ctypes.CFUNCTYPE(None, pointer, text, ctypes.c_int, text, text, text)
        self.log = kind(lambda _e, _n, _s, _c, _f, said: self.take(said))
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = ctypes.cast(self.log, fmi2CallbackLoggerTYPE)
        return callbacks

    def _of(self, name: str, name_of_3: str) -> Callable[..., Any]:
        return getattr(self.fmu, name_of_3 if self.is_3 else name)  # type: ignore[no-any-return]

    def enter(self) -> None:
        """Begin the initialisation."""
        if not self.is_3:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()

    def tries(self, what: str, call: Callable[[], Any]) -> None:
        """Do what is wrong, and keep the answer."""
        self.messages.clear()
        try:
            call()
            answer = ""
        except Exception as error:
            answer = str(error)
        self.answers[what] = (answer, list(self.messages))

    def misbehaves(self, t: float, other: bytes) -> None:
        """Do all that is wrong once a run goes on."""
        step, vr = self.fmu.doStep, self.vr
        self.tries("get unknown", lambda: self.get([99_999]))
        self.tries("set unknown", lambda: self.set([99_999], [1.0]))
        self.tries("get a text as a number", lambda: self.get([vr["label"]]))
        self.tries("set output", lambda: self.set([vr["level"]], [1.0]))
        self.tries("set fixed", lambda: self.set([vr["area"]], [3.0]))
        self.tries("set nan", lambda: self.set([vr["flow"]], [math.nan]))
        for h in (-H, 0.0, math.nan, math.inf):
            self.tries(f"step {h}", lambda h=h: step(t, h))
        for wrong in (t + 1.0, t - H, math.nan):
            self.tries(f"time {round(wrong - t, 3)}", lambda wrong=wrong: step(wrong, H))
        self.tries("enter again", self.fmu.enterInitializationMode)
        saved = self.to_bytes(self.save())
        changed = saved[:-3] + bytes([saved[-3] ^ 1]) + saved[-2:]
        wrong_states = {"half": saved[: len(saved) // 2], "empty": b"", "longer": saved + b" "}
        wrong_states |= {"changed": changed, "other": other, "text": b"{}" * 40}
        for what, data in wrong_states.items():
            self.tries(f"{what} state", lambda data=data: self.from_bytes(data))
        self.tries("no state", lambda: self.restore(None))
        self.restore(self.from_bytes(saved))


def main(path: str, folder: str, other: str, *refused: str) -> None:
    """Run; see the module."""
    host, levels = Host(path, folder), []
    is_python = host.description.coSimulation.needsExecutionTool
    if refused:
        host.tries("step before", lambda: host.fmu.doStep(0.0, H))
        host.tries("exit before", host.fmu.exitInitializationMode)
    host.enter()
    if refused:
        host.tries("step within", lambda: host.fmu.doStep(0.0, H))
    host.fmu.exitInitializationMode()
    host.set([host.vr["flow"]], [0.3])
    for k in range(20):
        if refused and k == 7:
            host.misbehaves(k * H, Path(other).read_bytes())
        host.fmu.doStep(k * H, H)
        levels += host.get([host.vr["level"]])
    Path(other).write_bytes(host.to_bytes(host.save()))
    host.fmu.terminate()
    if refused:
        host.tries("step after", lambda: host.fmu.doStep(20 * H, H))
    if refused and is_python:
        host.tries("set after", lambda: host.set([host.vr["flow"]], [1.0]))
        host.tries("terminate again", host.fmu.terminate)
        free = host.fmu.fmi3FreeInstance if host.is_3 else host.fmu.fmi2FreeInstance
        free(host.fmu.component)
        host.tries("get of none", lambda: host.get([host.vr["level"]]))
        host.tries("step of none", lambda: host.fmu.doStep(20 * H, H))
    print(json.dumps([levels, host.answers]))


if __name__ == "__main__":
    main(*sys.argv[1:])
