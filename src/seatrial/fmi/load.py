"""FMU files loaded: unpacked once, instantiated through FMPy with preallocated arrays."""

from __future__ import annotations

import ctypes
import hashlib
import itertools
import logging
import os
import re
import shutil
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import Any

import fmpy
from fmpy import fmi2
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelDescription, read_model_description

from ..errors import INTERRUPTED, DiscardError, InputError, SimulationError
from ..ports import Scalar
from .cache import cache_folder
from .instance import ByType, Reader, Variable, Writer

_TYPES = {"Real": float, "Integer": int, "Enumeration": int, "Boolean": bool, "String": str}
_CTYPES: dict[type, Any] = {
    float: ctypes.c_double,
    int: ctypes.c_int,
    bool: ctypes.c_int,
    str: ctypes.c_char_p,
}
_FMI_NAMES = {float: "Real", int: "Integer", bool: "Boolean", str: "String"}
_STATUS = ("ok", "warning", "discard", "error", "fatal", "pending")
_WARNING, _DISCARD, _ERROR, _FATAL = 1, 2, 3, 4
_KEPT_MESSAGES = 50


@dataclass(frozen=True)
class LoadedFmu:
    """An FMU file unpacked and described; instances are made from it."""

    path: Path
    folder: Path
    sha256: str
    description: ModelDescription
    variables: Mapping[str, Variable]
    feedthrough: Mapping[str, Sequence[str]]


@lru_cache(maxsize=256)
def _load(path: Path, _stamp: tuple[int, int]) -> LoadedFmu:
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    folder = _unpacked(path, sha256)
    try:
        description = read_model_description(folder, validate=False)
    except Exception as error:
        raise InputError(f"{path}: cannot read its model description: {error}") from None
    if description.fmiVersion != "2.0" or description.coSimulation is None:
        kind = "co-simulation" if description.coSimulation else "model exchange only"
        raise InputError(
            f"{path}: FMI {description.fmiVersion}, {kind}; FMI 2.0 co-simulation is needed"
        )
    variables = {v.name: _variable(v) for v in description.modelVariables}
    return LoadedFmu(path, folder, sha256, description, variables, _feedthrough(description))


def load_fmu(path: Path) -> LoadedFmu:
    """Unpack and read the FMU at ``path``.

    Raises InputError if it is not an FMI 2.0 co-simulation FMU for this machine.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    return _load(path.resolve(), (status.st_mtime_ns, status.st_size))


class FmuInstance(ByType):
    """An instance of a loaded FMU, as the master sees it."""

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self.name = name
        self.fmu = fmu
        self.variables, self.feedthrough = fmu.variables, fmu.feedthrough
        simulation = fmu.description.coSimulation
        self.rolls_back = bool(simulation.canGetAndSetFMUstate)
        self.any_step = bool(simulation.canHandleVariableCommunicationStepSize)
        self._ours = (fmu.description.generationTool or "").startswith("seatrial")
        self._fatal = False
        self._messages: list[tuple[int, str]] = []
        self._number = next(_numbers)
        self._logger = logging.getLogger(f"seatrial.fmu.{name}")
        self._slave = self._open(simulation.modelIdentifier)
        self._callbacks = self._make_callbacks()
        self._slave.component = None
        try:
            self._slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception:
            _listening.pop(self._number, None)
            raise SimulationError(
                f"{name}: {fmu.path.name} could not be instantiated{self._said()}"
            ) from None
        self._c = self._slave.component
        self._do_step = self._slave._functions["fmi2DoStep"]
        try:
            self._refuse_logged_errors("fmi2Instantiate")
        except SimulationError:
            self.free()
            raise

    def set_start(self, values: Mapping[str, Scalar]) -> None:
        """Set parameters and start values by variable name, before `initialise`."""
        if values:
            self.writer(list(values))(list(values.values()))

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._call("fmi2SetupExperiment", 0, 0.0, start_time, 1, stop_time)
        self._call("fmi2EnterInitializationMode")
        self._refuse_logged_errors("fmi2EnterInitializationMode")

    def begin(self) -> None:
        """End the initialisation."""
        self._call("fmi2ExitInitializationMode")
        self._refuse_logged_errors("fmi2ExitInitializationMode")

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s."""
        status = self._do_step(self._c, t, h, 1)
        if status > _WARNING:
            self._refuse(f"fmi2DoStep(t = {t!r} s, h = {h!r} s)", status)
        if self._messages:
            self._forward()

    def get_state(self) -> Any:
        """Return a handle of the whole state."""
        state = fmi2.fmi2FMUstate()
        self._call("fmi2GetFMUstate", ctypes.byref(state))
        return state

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""
        self._call("fmi2SetFMUstate", state)

    def free_state(self, state: Any) -> None:
        """Release a state's memory."""
        self._call("fmi2FreeFMUstate", ctypes.byref(state))

    def terminate(self) -> None:
        """End the run."""
        if not self._fatal:
            self._call("fmi2Terminate")
            self._refuse_logged_errors("fmi2Terminate")

    def free(self) -> None:
        """Release the instance; never after a fatal status, which has released it already.

        The library stays loaded: unloading pythonfmu's is not safe in every process.
        """
        if self._c is not None and not self._fatal:
            self._slave.fmi2FreeInstance(self._c)
        self._c = None
        _listening.pop(self._number, None)

    # ------------------------------------------------------------------ inside

    def _open(self, identifier: str) -> fmi2.FMU2Slave:
        description, folder = self.fmu.description, self.fmu.folder
        try:
            return fmi2.FMU2Slave(
                guid=description.guid,
                modelIdentifier=identifier,
                unzipDirectory=str(folder),
                instanceName=self.name,
            )
        except Exception as error:
            binaries = sorted(p.name for p in (folder / "binaries").glob("*"))
            raise InputError(
                f"{self.fmu.path}: cannot be loaded on this machine ({fmpy.platform}; the FMU has "
                f"binaries for {', '.join(binaries) or 'none'}): {error}"
            ) from None

    def _make_callbacks(self) -> fmi2.fmi2CallbackFunctions:
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = _logger_proxy()
        callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        callbacks.componentEnvironment = self._number
        _listening[self._number] = self._log
        return callbacks

    def _log(self, status: int, message: str) -> None:
        if len(self._messages) < _KEPT_MESSAGES:
            self._messages.append((status, message))

    def _call(self, function: str, *arguments: Any) -> None:
        status = self._slave._functions[function](self._c, *arguments)
        if status > _WARNING:
            self._refuse(function, status)

    def _reader(self, references: list[int], kind: type) -> Reader:
        count = len(references)
        vr = (ctypes.c_uint * count)(*references)
        values = (_CTYPES[kind] * count)()
        function = f"fmi2Get{_FMI_NAMES[kind]}"
        get, c = self._slave._functions[function], self._c

        def read() -> list[Any]:
            status = get(c, vr, count, values)
            if status > _WARNING:
                self._refuse(function, status)
            if self._messages:
                self._refuse_logged_errors(function)
            if kind is float or kind is int:
                plain: list[Any] = values[:]
                return plain
            if kind is bool:
                return [bool(v) for v in values]
            return [(v or b"").decode("utf-8", "replace") for v in values]

        return read

    def _writer(self, references: list[int], kind: type) -> Writer:
        count = len(references)
        vr = (ctypes.c_uint * count)(*references)
        own = (_CTYPES[kind] * count)()
        function = f"fmi2Set{_FMI_NAMES[kind]}"
        put, c = self._slave._functions[function], self._c

        def write(values: Sequence[Any]) -> None:
            own[:] = [v.encode() for v in values] if kind is str else values
            status = put(c, vr, count, own)
            if status > _WARNING:
                self._refuse(function, status)
            if self._messages:
                self._refuse_logged_errors(function)

        return write

    def _refuse(self, what: str, status: int) -> None:
        self._fatal = status == _FATAL
        word = _STATUS[status] if status < len(_STATUS) else str(status)
        said = self._said()
        if self._ours and said.endswith(INTERRUPTED):
            raise KeyboardInterrupt
        kind = DiscardError if status == _DISCARD else SimulationError
        raise kind(f"{self.name}: {what} returned {word}{said}")

    def _refuse_logged_errors(self, what: str) -> None:
        """Raise for an error that our own FMUs log instead of returning it (see `Slave`)."""
        if self._ours and any(status >= _ERROR for status, _ in self._messages):
            raise SimulationError(f"{self.name}: {what} failed{self._said()}")
        self._forward()

    def _said(self) -> str:
        texts = [text.strip() for _, text in self._messages]
        self._messages = []
        return ": " + "\n".join(texts) if texts else ", without a message"

    def _forward(self) -> None:
        for status, text in self._messages:
            level = (
                logging.ERROR if status >= _ERROR else logging.WARNING if status else logging.INFO
            )
            self._logger.log(level, "%s", text)
        self._messages = []


_numbers = itertools.count(1)
_listening: dict[int, Callable[[int, str], None]] = {}
"""Who takes the messages of which instance, by its component environment."""


def _dispatch(
    environment: int | None, instance: bytes, status: int, category: bytes, message: bytes
) -> None:
    listener = _listening.get(environment or 0)
    if listener is None:  # an instance of somebody else in this process
        fmi2.printLogMessage(environment, instance, status, category, message)
    else:
        listener(status, (message or b"").decode("utf-8", "replace"))


_template = fmi2.fmi2CallbackFunctions()
_dispatcher = fmi2.fmi2CallbackLoggerTYPE(_dispatch)


def _logger_proxy() -> Any:
    """Return FMPy's native logger, which formats printf arguments and calls `_dispatch`.

    The proxy knows one Python function for the whole process: so it must be one that lives
    for ever, and is registered again in case somebody else did meanwhile.
    """
    _template.logger = _dispatcher
    addLoggerProxy(ctypes.byref(_template))
    return _template.logger


def _variable(v: Any) -> Variable:
    kind = _TYPES[v.type]
    return Variable(
        name=v.name,
        causality=v.causality or "local",
        variability=v.variability or ("continuous" if kind is float else "discrete"),
        type=kind,
        reference=v.valueReference,
        unit=v.unit or (v.declaredType.unit if v.declaredType is not None else None) or "",
        start=None if v.start is None else _parsed(v.start, kind),
        minimum=None if v.min is None else float(v.min),
        maximum=None if v.max is None else float(v.max),
        nominal=None if v.nominal is None else float(v.nominal),
        description=v.description or "",
    )


def _parsed(text: Any, kind: type) -> Scalar:
    if kind is bool:
        return str(text).lower() in ("true", "1")
    return kind(text)  # type: ignore[no-any-return]


def _feedthrough(description: ModelDescription) -> dict[str, list[str]]:
    """Return the inputs each output depends on; on all, where the FMU says nothing."""
    inputs = [v.name for v in description.modelVariables if v.causality == "input"]
    result = {}
    for unknown in description.outputs:
        if unknown.dependencies is None:
            names = inputs
        else:
            names = [v.name for v in unknown.dependencies if v.causality == "input"]
        if names:
            result[unknown.variable.name] = names
    return result


def _unpacked(path: Path, sha256: str) -> Path:
    """Return the folder the FMU is unpacked in; unpack it if it is not there yet."""
    folder = cache_folder("unpacked") / sha256[:24]
    if _is_whole(folder, path):
        return folder
    temporary = Path(tempfile.mkdtemp(dir=folder.parent, prefix="unpacking-"))
    try:
        with zipfile.ZipFile(path) as archive:
            for member in archive.namelist():
                _refuse_outside(path, member)
            archive.extractall(temporary)
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError) as error:
        shutil.rmtree(temporary)
        raise InputError(f"{path}: not an FMU: {error}") from None
    except BaseException:
        shutil.rmtree(temporary)
        raise
    if folder.is_dir() and not _is_whole(folder, path):  # somebody removed a part of it
        shutil.rmtree(folder, ignore_errors=True)
    try:
        os.replace(temporary, folder)
    except OSError:  # another process was first
        shutil.rmtree(temporary, ignore_errors=True)
    return folder


def _is_whole(folder: Path, path: Path) -> bool:
    """Say if everything in the FMU is still there unpacked."""
    if not folder.is_dir():
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            return all((folder / name).exists() for name in archive.namelist())
    except (OSError, zipfile.BadZipFile):
        return False


def _refuse_outside(path: Path, member: str) -> None:
    parts = PurePosixPath(member).parts
    if ".." in parts or member.startswith("/") or re.match(r"[A-Za-z]:", member) or "\\" in member:
        raise InputError(f"{path}: member {member!r} would be unpacked outside its folder")
