"""Registries: what the core has under a name, what kits add, and what packages add alone.

Kits are described in `kits`. A package that adds a single name needs none: it writes the name in
its own ``pyproject.toml``. Nothing of it is imported before somebody asks for that name::

    [project.entry-points."seatrial.algorithms"]
    "my-algorithm" = "my_package.coupling:MyAlgorithm"
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pkgutil import resolve_name
from typing import Any

from .errors import InputError, unknown
from .kits import Entry, kits, lacking


class LibraryError(InputError):
    """A library is not installed that what somebody named needs."""


@dataclass(frozen=True)
class _Entry:
    """One name that a kit or a package adds."""

    origin: str
    name: str
    target: str


@dataclass(frozen=True)
class Registry:
    """Names of one kind and the objects behind them.

    A name that two packages add, or that a package adds although it is shipped, is an error when
    it is asked for, never a choice made in silence; other names are not affected.
    """

    group: str
    """Entry-point group that packages add names to."""
    noun: str
    """What one of them is, for messages."""
    shipped: Mapping[str, str]
    """``module:attribute`` by name."""

    def names(self) -> list[str]:
        """Return every name, shipped ones first."""
        of_kits = {name for kind, name in kits().by_name if kind == self._kind}
        added = sorted(of_kits | {entry.name for entry in _entries(self.group, tuple(sys.path))})
        return [*self.shipped, *(name for name in added if name not in self.shipped)]

    def target(self, name: str) -> str:
        """Return the ``module:attribute`` of a name. Raises InputError for none, or several."""
        entries = [
            *map(_of_kit, kits().by_name.get((self._kind, name), ())),
            *(each for each in _entries(self.group, tuple(sys.path)) if each.name == name),
        ]
        found = [f"{entry.origin} ({entry.target})" for entry in entries]
        targets = [entry.target for entry in entries]
        if name in self.shipped:
            found.insert(0, f"seatrial itself ({self.shipped[name]})")
            targets.insert(0, self.shipped[name])
        if not found:
            raise InputError(unknown(self.noun, name, self.names()) + kits().hint())
        if len(found) > 1:
            raise InputError(
                f"{self.noun} {name!r} comes from {' and from '.join(found)}; "
                f"one of them must give up the name in its kit or entry-point group {self.group!r}"
            )
        return targets[0]

    def load(self, name: str) -> Any:
        """Return the object of a name.

        Raises InputError for a name that `target` refuses, and for one whose module or attribute
        cannot be imported.
        """
        target = self.target(name)
        try:
            return resolve_name(target)
        except Exception as error:  # whatever somebody else's module does when it is imported
            if said := lacking(error):
                raise LibraryError(f"{self.noun} {name!r}: {said}") from None
            raise InputError(
                f"{self.noun} {name!r}: cannot load {target!r} of the entry-point group "
                f"{self.group!r}: {type(error).__name__}: {error}"
            ) from error

    @property
    def _kind(self) -> str:
        return self.group.removeprefix("seatrial.")


def _of_kit(entry: Entry) -> _Entry:
    return _Entry(f"the kit {entry.kit}", entry.name, entry.target)


@cache
def _entries(group: str, path: tuple[str, ...]) -> tuple[_Entry, ...]:
    """Return what the packages on ``sys.path``, which is ``path``, add to a group."""
    from importlib.metadata import entry_points  # imports much, and not every run comes here

    found = [
        _Entry(f"the package {point.dist.name if point.dist else '?'}", point.name, point.value)
        for point in entry_points(group=group)
    ]
    return tuple(sorted(found, key=lambda entry: (entry.name, entry.origin)))


_SERVICES = Registry("seatrial.services", "service", {})


def service(name: str) -> Any:
    """Return what a kit does for the core: ``KIT.FUNCTION`` of the ``services`` of its manifest.

    Raises InputError, naming the kit, where it is not there.
    """
    if name not in _SERVICES.names():
        kit = name.partition(".")[0]
        raise InputError(f"this needs the kit {kit!r}, which is not installed{kits().hint()}")
    return _SERVICES.load(name)


def offered(name: str) -> Any | None:
    """Return what a kit does for the core; None without the kit, or a library that it needs.

    See `service`.
    """
    if name not in _SERVICES.names():
        return None
    try:
        return _SERVICES.load(name)
    except LibraryError:
        return None
