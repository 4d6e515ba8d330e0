"""FMPy's classes for libraries that lack functions, as many that are meant to be optional."""

from __future__ import annotations

from typing import Any, NoReturn

from ...errors import SimulationError


class Missing:
    """A function that the library of ``instance`` lacks; it can be described, but not called."""

    def __init__(self, name: str, instance: str) -> None:
        self.name, self.instance = name, instance

    def __call__(self, *_arguments: Any) -> NoReturn:
        """Raise SimulationError."""
        raise SimulationError(f"{self.instance}: its library has no function {self.name}")


class _Library:
    """A loaded library that gives something for every name.

    In code, FMI's functions have the model identifier as a prefix; in libraries FMI 1.0's alone
    should. What was compiled otherwise is found all the same.
    """

    def __init__(self, library: Any, identifier: str, instance: str) -> None:
        self._library, self._prefix, self._instance = library, f"{identifier}_", instance

    def __getattr__(self, name: str) -> Any:
        plain = name.removeprefix(self._prefix)
        for one in (name, plain, self._prefix + plain):
            if (found := getattr(self._library, one, None)) is not None:
                return found
        return Missing(name, self._instance)


def lenient(library: type[Any]) -> type[Any]:
    """Return FMPy's class ``library``, with functions missing until somebody calls them.

    FMI has each function exported, used or not; FMUs of 20-sim, among others, leave out those of
    the capabilities that they do not have.
    """

    def load(self: Any) -> None:
        self.dll = _Library(self.dll, self.modelIdentifier, self.instanceName)
        library._loadFunctions(self)

    # FMPy takes the version from the name of the class.
    return type(library.__name__, (library,), {"_loadFunctions": load})
