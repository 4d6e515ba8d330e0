"""Index of components: the core's (``fmus/index.toml``), those of kits and of installed packages.

A kit lists components in its manifest (`kits`); a package adds single ones by the entry-point group
``seatrial.components`` (`plugins`).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from ...errors import InputError
from ...files.reading import toml_content
from ...kits import is_target, kits
from ...model.component import Component
from ...plugins import Registry
from ...shipped import shipped_folder

_KEYS = {"class", "title"}


@cache
def components() -> Registry:
    """Return the registry of component classes by FMU name. Raises InputError for a bad index."""
    targets = {name: entry["class"] for name, entry in _index().items()}
    return Registry("seatrial.components", "FMU", targets)


def title(name: str) -> str:
    """Return what a component is, for listings, without importing it."""
    entry = _index().get(name)
    if entry is not None:
        return entry["title"]
    of_kits = {entry.name: entry.text for entry in kits().entries("components")}
    return of_kits.get(name) or components().target(name)


def shipped_names() -> list[str]:
    """Return the components of the core and of kits, in alphabetical order."""
    return sorted({*_index(), *(entry.name for entry in kits().entries("components"))})


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
        if not is_target(str(entry["class"])):
            raise InputError(
                f"{path}: {name}.class: 'module:Class' needed, found {entry['class']!r}"
            )
    return content
