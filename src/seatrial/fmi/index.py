"""Index of components: those shipped (``fmus/index.toml``) and those of installed packages.

A package adds components by the entry-point group ``seatrial.components``; see
`seatrial.plugins`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from ..component import Component
from ..errors import InputError
from ..plugins import Registry
from ..reading import toml_content
from ..shipped import shipped_folder

_KEYS = {"class", "title"}


@cache
def components() -> Registry:
    """Return the registry of component classes by FMU name. Raises InputError for a bad index."""
    targets = {name: entry["class"] for name, entry in _index().items()}
    return Registry("seatrial.components", "FMU", targets)


def title(name: str) -> str:
    """Return what a component is, for listings, without importing it."""
    entry = _index().get(name)
    return entry["title"] if entry is not None else components().target(name)


def component_class(name: str) -> type[Component]:
    """Return the class of a name. Raises InputError for an unknown one, or no component."""
    found = components().load(name)
    if not (isinstance(found, type) and issubclass(found, Component)):
        target = components().target(name)
        raise InputError(f"FMU {name!r}: {target} is not a subclass of seatrial's Component")
    return found


@cache
def _index() -> Mapping[str, Mapping[str, str]]:
    path = shipped_folder("fmus") / "index.toml"
    try:
        content = toml_content(path.read_bytes(), str(path))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    for name, entry in content.items():
        if not (isinstance(entry, dict) and set(entry) == _KEYS):
            raise InputError(f'{path}: {name}: {{ class = "module:Class", title = "..." }} needed')
        module, colon, cls = str(entry["class"]).partition(":")
        if not (colon and cls.isidentifier() and all(p.isidentifier() for p in module.split("."))):
            raise InputError(f"{path}: {name}.class: 'module:Class' needed, found {module!r}")
    return content
