"""Kits: packages that bring components, commands, and content, each by one manifest.

A kit is a Python package with a file ``kit.toml`` and one entry point, which names the package::

    [project.entry-points."seatrial.kits"]
    sonar = "sonar_kit"

The manifest says in ``title`` what the kit is for and in ``api`` the version of the core's kit
interface that it needs, in ``needs`` the kits whose modules it imports, and has one table per kind
of part (`KINDS`). Nothing of a kit is imported before somebody asks for one of its parts. A kit
that cannot be used is left out, and named where something is not found.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from .errors import InputError, unknown
from .files.reading import toml_content

API = 1
"""Version of what kits find in the core. It rises when kits have to change."""
GROUP = "seatrial.kits"
OURS = ("seatrial", "seatrial_kits")
"""Top-level packages of this distribution: the core, and the kits that it ships."""
MANIFEST = "kit.toml"
CONTENT = "content"
"""Folder beside the manifest with the kit's vehicles, rigs, trials, campaigns and profiles."""

LIBRARIES = {
    "pygraphviz": "seatrial[diagrams]",
    "yaml": "seatrial[interchange]",
}
"""What pip installs for libraries of the core that few need, by the name that is imported."""
SYSTEM = {"pygraphviz": "libglib2.0-0 libx11-6 libxext6 libxrender1"}
"""Debian's packages of shared libraries that a wheel needs and does not bring."""

KINDS: Mapping[str, tuple[str, ...]] = {
    "algorithms": (),
    "commands": ("call", "help"),
    "components": ("class", "title"),
    "conditions": (),
    "criteria": (),
    "faults": (),
    "log_formats": (),
    "pages": (),
    "sections": (),
    "services": (),
    "terms": (),
    "transports": (),
}
"""Kinds of parts, and the keys of each: where it is, and what it is for; none: the place alone.

algorithms: coupling algorithms. commands: of ``seatrial``. components: as ``fmus/index.toml`` has
them. conditions: functions that say why a campaign leaves out a trial. criteria: functions of
criteria, `trial.criteria.expressions.Rule`. faults: of signals, `model.faults.catalogue.Kind`.
log_formats: of logs that are read, `trial.logs.formats.Format`. pages: functions that write a
further page of a campaign's folder. sections: functions that return further sections of a run's
report. services: functions that the core calls if they are there. terms: of the hydrodynamics of a
vehicle. transports: kinds of links.
"""
_TOP = ("api", "examples", "libraries", "needs", "title")


@dataclass(frozen=True)
class Entry:
    """A part of a kit."""

    kit: str
    name: str
    target: str
    """``module:attribute``."""
    text: str
    """What it is for; empty for kinds without."""


@dataclass(frozen=True)
class Kit:
    """A kit as its manifest describes it."""

    name: str
    title: str
    folder: Path
    needs: tuple[str, ...]
    entries: Mapping[str, tuple[Entry, ...]]
    """Parts by kind."""
    examples: Mapping[str, str]
    """Examples of its commands, for the end of their help, by command."""
    libraries: Mapping[str, str]
    """What pip installs for a library that may not be there, by the name that is imported."""

    @property
    def content(self) -> Path:
        """The folder of its content, which need not be there."""
        return self.folder / CONTENT


@dataclass(frozen=True)
class Kits:
    """The kits that are installed."""

    found: tuple[Kit, ...]
    left_out: Mapping[str, str]
    """Why a kit is not used, by its name."""

    def entries(self, kind: str) -> Iterator[Entry]:
        """Yield the parts of a kind, kit by kit."""
        for kit in self.found:
            yield from kit.entries.get(kind, ())

    @cached_property
    def by_name(self) -> Mapping[tuple[str, str], tuple[Entry, ...]]:
        """Parts by kind and name."""
        found: dict[tuple[str, str], tuple[Entry, ...]] = {}
        for kind in KINDS:
            for entry in self.entries(kind):
                found[kind, entry.name] = (*found.get((kind, entry.name), ()), entry)
        return found

    def hint(self) -> str:
        """Return what to add to a message that something is not found."""
        return "".join(
            f"; the kit {name} is left out: {why}" for name, why in self.left_out.items()
        )


def kits() -> Kits:
    """Return the kits that packages on ``sys.path`` have."""
    return _kits(tuple(sys.path))


@cache
def _kits(path: tuple[str, ...]) -> Kits:
    """Return the kits of the packages on ``sys.path``, which is ``path``."""
    from importlib.metadata import entry_points  # imports much

    found: dict[str, Kit] = {}
    left_out: dict[str, str] = {}
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        try:
            kit = read_kit(point.name, _folder(point.value))
            if point.name in found and found[point.name].folder != kit.folder:
                raise InputError(f"two packages have a kit of this name: {kit.folder}")
            found[point.name] = kit
        except InputError as error:
            left_out[point.name] = str(error)
    while needing := {n: e for n, kit in found.items() for e in kit.needs if e not in found}:
        for name, needed in needing.items():
            left_out[name] = f"it needs the kit {needed}, which is not there"
            del found[name]
    return Kits(tuple(found.values()), left_out)


def _folder(package: str) -> Path:
    """Return where a package lies, which is not imported. Raises InputError."""
    try:
        spec = importlib.util.find_spec(package)
    except (ImportError, ValueError):
        spec = None
    places = None if spec is None else spec.submodule_search_locations
    if not places:
        raise InputError(f"its package {package} is not there: install it again, or remove it")
    return Path(next(iter(places)))


def read_kit(name: str, folder: Path) -> Kit:
    """Return the kit whose manifest lies in ``folder``. Raises InputError, with file and key."""
    path = folder / MANIFEST
    try:
        content = toml_content(path.read_bytes(), str(path))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    for key in content:
        if key not in (*_TOP, *KINDS):
            raise InputError(f"{path}: {unknown('key', key, (*_TOP, *KINDS))}")
    if content.get("api") != API:
        version = content.get("api")
        raise InputError(f"{path}: api = {version!r}, this seatrial has kits of api = {API}")
    title, needs = content.get("title"), content.get("needs", [])
    if not isinstance(title, str):
        raise InputError(f"{path}: title: a text is needed, found {title!r}")
    if not (isinstance(needs, list) and all(isinstance(each, str) for each in needs)):
        raise InputError(f"{path}: needs: names of kits are needed, found {needs!r}")
    for key in KINDS:
        if not isinstance(content.get(key, {}), dict):
            raise InputError(f"{path}: {key}: a table is needed, found {content[key]!r}")
    entries = {
        kind: tuple(_entry(path, name, kind, key, value) for key, value in table.items())
        for kind, table in content.items()
        if kind in KINDS
    }
    texts = {key: content.get(key, {}) for key in ("examples", "libraries")}
    for key, table in texts.items():
        if not (isinstance(table, dict) and all(isinstance(text, str) for text in table.values())):
            raise InputError(f"{path}: {key}: a table of texts is needed, found {table!r}")
    return Kit(name, title, folder, tuple(needs), entries, **texts)


def _entry(path: Path, kit: str, kind: str, name: str, value: Any) -> Entry:
    """Return a part. Raises InputError for one that is not written as its kind is."""
    place = f"{path}: {kind}.{name}"
    if keys := KINDS[kind]:
        shape = ", ".join(f'{key} = "..."' for key in keys)
        if not (isinstance(value, dict) and set(value) == set(keys)):
            raise InputError(f"{place}: {{ {shape} }} is needed, found {value!r}")
        target, text = (value[key] for key in keys)
    else:
        target, text = value, ""
    if not (isinstance(target, str) and isinstance(text, str) and is_target(target)):
        raise InputError(f"{place}: 'module:attribute' is needed, found {target!r}")
    return Entry(kit, name, target, text)


def lacking(error: Exception) -> str | None:
    """Return the reason why an optional library is not there; None for any other error.

    It is not installed, or a shared library of the operating system that it needs is not.
    """
    if not isinstance(error, ImportError):
        return None
    known = {name: text for kit in kits().found for name, text in kit.libraries.items()} | LIBRARIES
    # Of an extension module the name is that of its file alone: its folder is the library's.
    names = ((error.name or "").partition(".")[0], Path(error.path or "").parent.name)
    library = next((name for name in names if name in known), None)
    if library is None:
        return None
    if isinstance(error, ModuleNotFoundError):
        return f'{library} is not installed: pip install "{known[library]}"'
    needs = f"; on Debian: apt install {SYSTEM[library]}" if library in SYSTEM else ""
    return f"{library} is installed and does not load: {error.msg}{needs}"


def is_ours(module: str) -> bool:
    """Return whether a module is of this distribution."""
    return module.partition(".")[0] in OURS


def is_target(text: str) -> bool:
    """Return whether a text is ``module:attribute``."""
    module, colon, attribute = text.partition(":")
    return (
        bool(colon) and attribute.isidentifier() and all(map(str.isidentifier, module.split(".")))
    )
