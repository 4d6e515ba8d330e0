"""The slave: a component behind pythonfmu, hardened against what its binary cannot take.

pythonfmu's binary turns any Python exception into fmi2Fatal and frees the instance while the
host still holds it. So nothing raises here: errors are logged with their traceback, kept in
``last_error``, and the next step is discarded. Where a library of ours is in front of that binary,
the call that logs an error fails, and a value that is refused does no more than that.
"""

from __future__ import annotations

import _ctypes
import contextlib
import ctypes
import importlib
import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from ..errors import INTERRUPTED, InputError, SimulationError
from ..model.component import Component

START_VALUES = "start_values.json"
"""File in an FMU's resources: start values by port name, baked in when it was built."""


_LONGEST_TRACE = 1200


class Slave(Fmi2Slave):  # type: ignore[misc]
    """A component as an FMI 2.0 co-simulation slave.

    A subclass names its ``component_class`` and defines an ``__init__`` of its own, in the
    script of the FMU: pythonfmu's binary releases the script's globals once too often, and
    only a function defined there keeps them alive at the second instantiation.
    """

    component_class: ClassVar[type[Component]]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        while self.resources in sys.path:
            sys.path.remove(self.resources)
        libraries = _behind_ours(self.resources)
        _drop_interpreter_handle(self.resources, libraries)
        _follow_to(self.resources)
        self._reports_at_once = bool(libraries)
        self.last_error: str | None = None
        self._failed = False
        self.component = self.component_class(self.instance_name)
        self._guarded(self._apply_start_values)

    # ------------------------------------------------------------------ calls of the host

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Take the start time."""
        self._guarded(lambda: self.component.setup(start_time))

    def enter_initialization_mode(self) -> None:
        """Start the component."""
        _follow_to(self.resources)  # the folder of before may be gone since this one was made
        self._guarded(self.component.initialise)

    def exit_initialization_mode(self) -> None:
        """Freeze the fixed parameters."""
        self._guarded(self.component.begin)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance; False (fmi2Discard) after an error, from now on until reset or rollback."""
        if not self._failed:
            self._guarded(lambda: self.component.advance(current_time, step_size))
        elif self.last_error is not None:
            self._log(f"step refused after an earlier error: {self.last_error}")
        return not self._failed

    def terminate(self) -> None:
        """End the run."""
        self._guarded(self.component.close)

    def __del__(self) -> None:
        """Let go of what is outside; a run that failed is freed without being terminated."""
        with contextlib.suppress(BaseException):
            self.component.close()

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return Real variables; NaN after an error, which the next step reports."""
        return self._read(vrs, float, math.nan)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return Integer variables; zeros after an error, which the next step reports."""
        return self._read(vrs, int, 0)

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Return Boolean variables; False after an error, which the next step reports."""
        return self._read(vrs, bool, False)

    def get_string(self, vrs: list[int]) -> list[str]:
        """Return String variables; empty after an error, which the next step reports."""
        return self._read(vrs, str, "")

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real variables; an error is reported by the next step."""
        self._write(vrs, values, float)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer variables; an error is reported by the next step."""
        self._write(vrs, values, int)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean variables; an error is reported by the next step."""
        self._write(vrs, values, bool)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Set String variables; an error is reported by the next step."""
        self._write(vrs, values, str)

    # ------------------------------------------------------------------ state

    def _get_fmu_state(self) -> dict[str, Any]:
        """Return the whole state; without the component's, after an error, which is logged.

        An instance that cannot save its state goes on: only restoring such a state fails.
        """
        state: dict[str, Any] = {"failed": self._failed, "last_error": self.last_error}
        try:
            state["component"] = self.component.get_state()
        except BaseException as error:
            self._log(_explained(error))
        return state

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        if not {"component", "failed", "last_error"} <= set(state):
            self._fail(f"{self.instance_name}: this state cannot be restored")
            return
        self._failed, self.last_error = state["failed"], state["last_error"]
        self._guarded(lambda: self.component.set_state(state["component"]))

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        return json.dumps(_to_json(state)).encode()

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any]:
        try:
            restored = _from_json(json.loads(state.decode()))
        except (ValueError, KeyError, TypeError):
            return {}  # an exception here would be fatal; setting this state fails instead
        return restored if isinstance(restored, dict) else {}

    # ------------------------------------------------------------------ inside

    def _apply_start_values(self) -> None:
        path = Path(self.resources or "") / START_VALUES
        if path.is_file():
            for name, value in json.loads(path.read_text("utf-8")).items():
                self.component.set(name, value)

    def _read(self, vrs: Sequence[int], kind: type, default: Any) -> list[Any]:
        try:
            return self.component.read(vrs, kind)
        except BaseException as error:
            self._refuse_access(error)
            return [default] * len(vrs)

    def _write(self, vrs: Sequence[int], values: Sequence[Any], kind: type) -> None:
        try:
            self.component.write(vrs, values, kind)
        except BaseException as error:
            self._refuse_access(error)

    def _refuse_access(self, error: BaseException) -> None:
        """Log what the host did wrong; the next step fails of it if no earlier call can."""
        is_harmless = self._reports_at_once and isinstance(error, InputError)
        (self._log if is_harmless else self._fail)(_explained(error))

    def _guarded(self, call: Callable[[], Any]) -> None:
        try:
            call()
        except BaseException as error:
            self._fail(_explained(error))

    def _fail(self, message: str) -> None:
        self._failed = True
        self.last_error = message
        self._log(message)

    def _log(self, message: str) -> None:
        # FMI's message is a printf format.
        text = message.replace("\0", "\\0").replace("%", "%%")
        self.log(text.encode("utf-8", "replace").decode(), Fmi2Status.error)


def _behind_ours(resources: str | None) -> list[Path]:
    """Return pythonfmu's library if one of ours has loaded it, nothing if the host has."""
    suffix = "dll" if sys.platform == "win32" else "so"
    launched = Path(resources or "", "python", "lib").glob("libpythonfmu-export.so")
    return [*launched, *Path(resources or "", "pythonfmu").glob(f"*.{suffix}")]


def _drop_interpreter_handle(resources: str | None, libraries: Sequence[Path]) -> None:
    """Release the binary's handle of the interpreter now, because at unloading it does so twice.

    The second release writes to freed memory: a process can die of it after all work is done.
    Where the binary itself started the interpreter it still needs the handle, to end it. That of a
    standalone FMU, which its launcher loads, never does.
    """
    if not resources or sys.platform != "linux":
        return
    if not Path(resources, "python").is_dir() and not sys.orig_argv:
        return
    for path in libraries or (Path(resources).parent / "binaries" / "linux64").glob("*.so"):
        library = ctypes.CDLL(str(path), mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
        library.finalizePythonInterpreter()
        _ctypes.dlclose(library._handle)


def _follow_to(resources: str) -> None:
    """Let the bundle's modules look for files and submodules in ``resources``.

    They were imported once for the process, from the folder of the first instance, which is
    gone when that instance is: the next one finds its data files and late imports in its own.
    """
    root = __name__.partition(".")[0]
    old = Path(getattr(sys.modules[root], "__file__", None) or __file__).parent
    new = Path(resources, root)
    if old.is_dir() or not new.is_dir():
        return
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] != root or not getattr(module, "__file__", None):
            continue
        file = new / Path(str(module.__file__)).relative_to(old)
        module.__file__ = str(file)
        if hasattr(module, "__path__"):
            module.__path__ = [str(file.parent)]
    importlib.invalidate_caches()


def _explained(error: BaseException) -> str:
    """Return an error's message; with the traceback unless it is written for users.

    The error itself comes first, and a long traceback loses its middle: hosts cut messages.
    """
    if isinstance(error, (InputError, SimulationError)):
        return str(error)
    if isinstance(error, KeyboardInterrupt):
        return INTERRUPTED
    first = "".join(traceback.format_exception_only(error)).strip()
    trace = "".join(traceback.format_exception(error)).strip()
    if len(trace) > _LONGEST_TRACE:
        half = _LONGEST_TRACE // 2
        begin, end = trace[:half].rpartition("\n")[0], trace[-half:].partition("\n")[2]
        trace = f"{begin}\n  ...\n{end}"  # whole lines: a part of a path is no path
    return f"{first[:_LONGEST_TRACE]}\n{trace}"


def _to_json(value: Any) -> Any:
    """Return plain data as JSON's types: arrays, tuples and odd keys are tagged."""
    if isinstance(value, np.ndarray):
        flat = [_to_json(v) for v in value.ravel().tolist()]
        return {"array": flat, "shape": list(value.shape), "dtype": value.dtype.str}
    if isinstance(value, tuple):
        return {"tuple": [_to_json(v) for v in value]}
    if isinstance(value, list):
        return [_to_json(v) for v in value]
    if isinstance(value, dict):
        return {"dict": [[_to_json(k), _to_json(v)] for k, v in value.items()]}
    if isinstance(value, float) and not math.isfinite(value):
        return {"float": repr(value)}
    return value


def _from_json(value: Any) -> Any:
    if isinstance(value, list):
        return [_from_json(v) for v in value]
    if not isinstance(value, dict):
        return value
    if "array" in value:
        flat = np.array(_from_json(value["array"]), dtype=value["dtype"])
        return flat.reshape(value["shape"])
    if "tuple" in value:
        return tuple(_from_json(v) for v in value["tuple"])
    if "float" in value:
        return float(value["float"])
    return {_from_json(k): _from_json(v) for k, v in value["dict"]}
