"""Import paths of before 0.2: they work until 0.3, with a DeprecationWarning."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any, cast

DATA_FILES = ("moved.txt",)
_LINES = Path(__file__).with_name("moved.txt").read_text("ascii").splitlines()
MOVED = dict(line.split() for line in _LINES)
"""Modules and packages of ``seatrial``, and where they are now."""
_PREFIX = "seatrial."


class MovedFinder:
    """Finds modules by the paths that they had: the same modules, not copies.

    Without the base classes of `importlib.abc`, whose import takes as long as all of this package.
    """

    _spec: ModuleSpec | None = None

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return how a moved module is loaded; None for all others."""
        new = moved_to(fullname)
        return None if new is None else ModuleSpec(fullname, cast(Any, self), origin=new)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module of the new path."""
        assert spec.origin is not None
        warnings.warn(
            f"{spec.name} is {spec.origin} now; the old path is gone in 0.3",
            DeprecationWarning,
            stacklevel=2,
        )
        module = importlib.import_module(spec.origin)
        self._spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Leave the module what it is: it ran when it was imported."""
        module.__spec__ = self._spec


def moved_to(name: str) -> str | None:
    """Return where a module is that had another name; None of any other name."""
    if not name.startswith(_PREFIX):
        return None
    old, rest = name.removeprefix(_PREFIX), ""
    while old:
        if old in MOVED:
            return MOVED[old] + rest
        old, dot, last = old.rpartition(".")
        rest = f"{dot}{last}{rest}"
    return None


def find_moved() -> None:
    """Let Python find modules by their old paths, before it looks into the packages' folders."""
    if not any(isinstance(finder, MovedFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, MovedFinder())
