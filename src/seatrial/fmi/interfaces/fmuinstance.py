"""Base of instances of every version of FMI: library, statuses, messages, life."""

from __future__ import annotations

import ctypes
import os
import re
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from ...errors import INTERRUPTED, DiscardError, FatalError, InputError, SimulationError
from ...model.serialisation import is_c_text
from ..files.lenient import Missing, lenient
from ..instance import ByType, Reader, Value, Variable, Writer
from ..messages import ACCEPTED, DISCARD, FATAL, Messages, word
from .loaded import LoadedFmu
from .origins import with_origins

_INTERRUPTIONS = INTERRUPTED, f"{KeyboardInterrupt()!r}"
"""How our own FMUs say that one was interrupted: a component, or pythonfmu beside it (fatal)."""


class FmuInstance(ByType):
    """An instance of a loaded FMU, as the master sees it.

    FMI's functions are called as FMPy loaded them, not through its wrappers, which cost more
    than many an FMU. Every call that fails raises SimulationError with what the FMU said.
    """

    _prefix: ClassVar[str]
    """Of the names of FMI's functions, as FMPy has them."""
    _state_word: ClassVar[str]
    """How this version of FMI writes the state in names of functions."""
    _free_word: ClassVar[str] = "FreeInstance"
    _terminate_word: ClassVar[str] = "Terminate"
    """How this version of FMI calls these functions."""
    _library: ClassVar[type[Any]]
    """FMPy's class for such an FMU."""

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self.name = name
        self.fmu = fmu
        self.variables, self.feedthrough = fmu.variables, fmu.feedthrough
        self.terminals, self.views = fmu.terminals, fmu.views
        self.rolls_back, self.any_step = fmu.rolls_back, fmu.any_step
        self.at_once = fmu.at_once
        self.restarts = False
        self.never_back = 1
        """FMI's noSetFMUStatePriorToCurrentPoint: what the master will do, not what the FMU can."""
        self.ended_at: float | None = None
        self._ours = (fmu.description.generationTool or "").startswith("seatrial")
        self._fatal = False
        self._messages = Messages(name, lambda text: with_origins(text, fmu))
        self._slave = self._opened(fmu.simulation.modelIdentifier)
        self._functions: dict[str, Any] = {
            function.removeprefix(self._prefix): call
            for function, call in self._slave._functions.items()
        }
        self._c: Any = None
        try:
            self._instantiate()
        except SimulationError:
            raise
        except Exception:
            said = self._messages.said()
            self.free()
            raise SimulationError(
                f"{name}: {fmu.path.name} could not be instantiated{said}"
            ) from None
        self._c = self._slave.component
        try:
            self._refuse_logged_errors("Instantiate")
        except SimulationError:
            self.free()
            raise

    @abstractmethod
    def _instantiate(self) -> None:
        """Instantiate the slave, with its messages going to ours."""

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a callable that returns the values of ``names``, in that order."""
        self._refuse_fatal()
        return super().reader(names)

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a callable that sets ``names`` to a sequence of values."""
        self._refuse_fatal()
        return super().writer(names)

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set parameters and start values by variable name, before `initialise`."""
        if values:
            self.writer(list(values))(list(values.values()))

    def goes_back(self, may: bool) -> None:
        """Say whether a state of before the next step may be restored after it."""
        self.never_back = int(not may)

    def get_state(self) -> Any:
        """Return a handle of the whole state."""
        state, function = ctypes.c_void_p(), f"Get{self._state_word}"
        self._call(function, ctypes.byref(state))
        try:
            self._refuse_logged_errors(function)
        except SimulationError:
            self._call(f"Free{self._state_word}", ctypes.byref(state))
            raise
        return state

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""
        self.ended_at = None
        self._call(f"Set{self._state_word}", state)
        self._refuse_logged_errors(f"Set{self._state_word}")

    def free_state(self, state: Any) -> None:
        """Release a state's memory; with the instance, it has gone already."""
        if self._c is not None and not self._fatal:
            self._call(f"Free{self._state_word}", ctypes.byref(state))

    def reset(self) -> None:
        """Return to before `set_start`."""
        self.ended_at = None
        self._call("Reset")
        self._refuse_logged_errors("Reset")

    def terminate(self) -> None:
        """End the run."""
        if not self._fatal:
            self._call(self._terminate_word)
            self._refuse_logged_errors(self._terminate_word)

    def free(self) -> None:
        """Release the instance; never after a fatal status, which has released it already.

        The library stays loaded: unloading pythonfmu's is not safe in every process.
        """
        if self._c is not None and not self._fatal:
            self._functions[self._free_word](self._c)
        self._c = None

    def forward(self) -> None:
        """Log what the FMU has said since."""
        self._messages.forward()

    def address(self, function: str) -> int:
        """Return where a function of the library is, 0 if it has none of that name."""
        found = self._functions[function]
        return 0 if isinstance(found, Missing) else ctypes.cast(found, ctypes.c_void_p).value or 0

    @property
    def component(self) -> int:
        """What its functions take first, as C has it."""
        return int(self._c if isinstance(self._c, int) else self._c.value)

    # ------------------------------------------------------------------ inside

    def _opened(self, identifier: str) -> Any:
        """Return FMPy's class with the library loaded."""
        description, folder = self.fmu.description, self.fmu.folder
        library = self.fmu.binary
        if lacking := self.fmu.lacking:
            raise InputError(f"{self.fmu.path}: {lacking}")
        before = os.getcwd()
        try:
            opened = lenient(self._library)(
                guid=description.guid or "",
                modelIdentifier=identifier,
                unzipDirectory=str(self.fmu.built or folder),
                instanceName=self.name,
            )
            opened.unzipDirectory = str(folder)  # where its resources are
            return opened
        except Exception as error:
            os.chdir(before)  # FMPy stays in the library's folder when it cannot be loaded
            raise InputError(
                f"{self.fmu.path}: binaries/{self.fmu.platform}/{library.name} cannot be loaded on "
                f"this machine: {reason(error)}"
            ) from None

    @property
    def _fmi(self) -> str:
        """The prefix as the standard has it."""
        return self._prefix.removesuffix("1")

    def _call(self, function: str, *arguments: Any) -> None:
        self._refuse_fatal()
        status = self._functions[function](self._c, *arguments)
        if status not in ACCEPTED:
            self._refuse(function, status)

    def _refuse(self, what: str, status: int) -> None:
        """Raise for a status that is neither ok nor a warning."""
        self._fatal = status == FATAL
        said = self._said()
        kinds = {DISCARD: DiscardError, FATAL: FatalError}
        raise kinds.get(status, SimulationError)(
            f"{self.name}: {self._fmi}{what} returned {word(status)}{said}"
        )

    def _refuse_logged_errors(self, what: str) -> None:
        """Raise for an error that our own FMUs log instead of returning it (see `Slave`)."""
        if self._ours and self._messages.has_error():
            raise SimulationError(f"{self.name}: {self._fmi}{what} failed{self._said()}")
        self._messages.forward()

    def _said(self) -> str:
        """Return what the FMU said. Raises KeyboardInterrupt if that is what it met."""
        said = self._messages.said()
        if self._ours and said.endswith(_INTERRUPTIONS):
            raise KeyboardInterrupt
        return said

    def _refuse_fatal(self) -> None:
        """Raise FatalError for an instance of which FMI allows no call any more."""
        if self._fatal:
            raise FatalError(f"{self.name}: it has returned fatal, and may not be called again")

    @abstractmethod
    def _getter(self, variables: list[Variable], kind: Any) -> Reader:
        """Return a callable that reads variables of one kind in one call."""

    @abstractmethod
    def _setter(self, variables: list[Variable], kind: Any) -> Writer:
        """Return a callable that sets variables of one kind in one call."""

    def _type(self, variable: Variable) -> Any:
        """Return what chooses the functions for a variable: its type."""
        return variable.type

    def _kind(self, variable: Variable) -> Any:
        return self._type(variable)

    def _reader(self, variables: list[Variable], kind: Any) -> Reader:
        return self._getter(variables, kind)

    def _writer(self, variables: list[Variable], kind: Any) -> Writer:
        return self._setter(variables, kind)

    def _refuse_unfit(
        self, variables: Sequence[Variable], kind: Any, values: Sequence[Any]
    ) -> None:
        """Raise SimulationError for a value that C would change to fit its type."""
        if kind is int:
            self._refuse_excess(variables, values)
        elif kind is str:
            self._encoded(variables, values)

    def _refuse_excess(self, variables: Sequence[Variable], values: Sequence[int]) -> None:
        """Raise SimulationError for an integer that C would cut to fit its type."""
        for variable, value in zip(variables, values, strict=True):
            low, high = variable.integers
            if not low <= value <= high:
                raise SimulationError(
                    f"{self.name}.{variable.name}: {value} does not fit its type, {low} to {high}"
                )

    def _encoded(self, variables: Sequence[Variable], texts: Sequence[str]) -> list[bytes]:
        """Return texts for C. Raises SimulationError for one that C would cut."""
        for variable, text in zip(variables, texts, strict=True):
            if not is_c_text(text):
                raise SimulationError(f"{self.name}.{variable.name}: {text!r} is no C text")
        return [text.encode() for text in texts]


_MISSING = re.compile(r"(?:^|\s)([^\s/:]+\.so[.\d]*): cannot open shared object file")
_VERSION = re.compile(r"\S*?([^\s/:]+): version `([^']+)' not found")
_SYMBOL = re.compile(r"undefined symbol: ([^\s,]+)")
_NAME = re.compile(r"(lib.+?)\.so\.?(.*)")
_PACKAGES = {
    "libgfortran.so.3": "libgfortran3, which Debian has up to 9 and Ubuntu up to 18.04",
    "libcrypto.so.1.0.0": "libssl1.0.0",
    "libcrypto.so.1.1": "libssl1.1",
    "libcrypto.so.3": "libssl3",
}


def reason(error: Exception) -> str:
    """Return which library or symbol is missing, and what to install; else what was said."""
    said = str(error)
    if found := _MISSING.search(said):
        name = found[1]
        return f"it needs the shared library {name}, which is not installed{_package(name)}"
    if found := _VERSION.search(said):
        return f"it needs {found[1]} of a newer version, one that has {found[2]}"
    if found := _SYMBOL.search(said):
        return f"it needs the symbol {found[1]}, which none of its libraries has"
    return said


def _package(library: str) -> str:
    """Return where Debian has a library; its packages are called after name and version."""
    if library in _PACKAGES:
        return f" (package {_PACKAGES[library]})"
    name = _NAME.fullmatch(library)
    if name is None or not name[2]:
        return ""
    if name[1].startswith("libpython"):
        return f" (package {name[1]})"
    hyphen = "-" if name[1][-1].isdigit() else ""
    package = f"{name[1]}{hyphen}{name[2]}".lower().replace("_", "-")
    return f" (on Debian and Ubuntu most likely package {package})"
