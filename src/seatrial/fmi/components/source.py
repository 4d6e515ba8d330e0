"""Sources of FMUs: names of the index, and files: FMUs, classes in Python, tables, policies."""

from __future__ import annotations

import ast
import hashlib
import importlib
import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

from ...errors import InputError, unknown
from ...files.reading import toml_content
from ...kits import OURS
from ...model.component import Component
from ...plugins import service
from .index import component_class, components, shipped_names, title
from .stored_table import SUFFIX, content_of, stored_head
from .table import table_component
from .table_file import LARGEST, SUFFIXES, frozen_table

# The method is there because pythonfmu's binary releases the script's globals once too often: only
# a function that is defined in the script keeps them alive at the second instantiation.
_SCRIPT = '''"""{name}: {class_name} as an FMU."""

from {module} import {class_name}
from seatrial.fmi.slave import Slave


class {class_name}Fmu(Slave):
    """FMU of `{class_name}`."""

    component_class = {class_name}

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
'''


@dataclass(frozen=True)
class ComponentSource:
    """A component that can be built into an FMU, or run in process."""

    name: str
    """The FMU's name, as rigs write it."""
    stem: str
    """The same as an identifier."""
    module: str
    class_name: str
    origin: str
    """What the user wrote, for messages."""
    folder: Path | None = None
    """Where the module and those beside it lie, if they are a user's files."""

    @property
    def script(self) -> bytes:
        """Text of the FMU's slave script."""
        text = _SCRIPT.format(name=self.name, module=self.module, class_name=self.class_name)
        return text.encode()

    def imported(self, alias: str) -> str:
        """Return the lines of a script that give the class a name."""
        return f"from {self.module} import {self.class_name} as {alias}"

    @property
    def package(self) -> str | None:
        """Top-level package of somebody else that has to travel in the FMU."""
        top = self.module.partition(".")[0]
        return None if self.folder is not None or top in OURS else top

    @property
    def title(self) -> str:
        """What it is, for listings; of a user's file, its class."""
        return title(self.name) if self.folder is None else self.class_name

    def portable(self) -> ComponentSource:
        """Return this; raises InputError for one that runs in this process alone."""
        return self

    def component_class(self) -> type[Component]:
        """Return the component's class, from the modules as they lie on disk.

        Raises InputError if it cannot be imported, or is no component.
        """
        if self.folder is None:
            return component_class(self.name)
        with _importable(self.folder):
            try:
                module: Any = importlib.import_module(self.module)
            except InputError:
                raise
            except Exception as error:
                raise InputError(
                    f"{self.origin}: cannot be imported: {type(error).__name__}: {error}"
                ) from error
        if not hasattr(module, self.class_name):
            names = [n for n, v in vars(module).items() if _is_component(v)]
            raise InputError(f"{self.origin}: {unknown('component', self.class_name, names)}")
        cls = getattr(module, self.class_name)
        if not _is_component(cls):
            raise InputError(f"{self.origin}: {cls!r} is not a subclass of seatrial's Component")
        return cls  # type: ignore[no-any-return]


_TABLE_SCRIPT = '''"""{name}: a table of values over time as an FMU."""

from seatrial.fmi.slave import Slave
from seatrial.fmi.components.table import table_component

Table = table_component({text!r})


class TableFmu(Slave):
    """FMU of the table."""

    component_class = Table

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
'''


@dataclass(frozen=True)
class TableSource(ComponentSource):
    """A table of values over time, which is a component with its columns as outputs."""

    text: str = ""
    """The table, as `frozen_table` and `stored_head` return it."""
    is_stored: bool = False
    """Whether its values stay in a file."""

    @property
    def script(self) -> bytes:
        """Text of the FMU's slave script, with all values, or the hash of those in a file."""
        return _TABLE_SCRIPT.format(name=self.name, text=content_of(self.text)).encode()

    @property
    def title(self) -> str:
        """What it is, for listings."""
        return f"table of {self.name}"

    def component_class(self) -> type[Component]:
        """Return the component."""
        return table_component(self.text)

    def imported(self, alias: str) -> str:
        """Return the lines of a script that give the class a name."""
        return (
            f"from seatrial.fmi.components.table import table_component\n"
            f"{alias} = table_component({self.portable().text!r})"
        )

    def portable(self) -> TableSource:
        """Return this; raises InputError for a table whose values no FMU can carry."""
        if self.is_stored:
            raise InputError(
                f"{self.origin}: a table of more than {LARGEST >> 20} MiB plays in process alone, "
                "and is no FMU: --engine direct"
            )
        return self


def table_source(path: Path, types: Mapping[str, type] | None = None) -> TableSource:
    """Return the component of a file of values over time; see `frozen_table`. Raises InputError."""
    if not path.is_file():
        raise InputError(f"there is no table {path}")
    if path.suffix == SUFFIX:
        return replace(_table(path, stored_head(path)), is_stored=True)
    return _table(path, frozen_table(path, types))


def _table(path: Path, text: str) -> TableSource:
    stem = re.sub(r"\W", "_", f"table_{path.stem}", flags=re.ASCII)
    of = hashlib.sha256(text.encode()).hexdigest()[:12]
    return TableSource(
        path.name, stem, "seatrial.fmi.components.table", f"Table_{of}", str(path), None, text
    )


def _of_data(path: Path) -> ComponentSource:
    """Return the component of a file of data, which its keys tell apart. Raises InputError."""
    content = toml_content(path.read_bytes(), str(path)) if path.is_file() else {}
    if "network" in content:
        source: ComponentSource = service("learning.policy_source")(path)
        return source
    if content and "log" not in content:
        found = ", ".join(content)
        raise InputError(
            f"{path}: log, of a log that is played, or network, of a trained one, is needed; found "
            f"{found}"
        )
    return _table(path, service("logs.played")(path))


def find_source(text: str, relative_to: Path) -> ComponentSource | Path:
    """Return what ``text`` names: a component, or the path of an ``.fmu`` file.

    ``text`` is ``path/to/x.fmu``, ``path/to/my_boat.py:Class``, ``path/to/inputs.csv`` or
    ``.parquet``, ``path/to/data.toml``, which says what of a log is played or what a trained
    network means (all relative to the file that says it), or a name of the index. Raises
    InputError if there is nothing there.
    """
    if text.endswith(".toml"):
        return _of_data((relative_to / text).resolve())
    if text.endswith((*SUFFIXES, SUFFIX)):
        return table_source((relative_to / text).resolve())
    if text.endswith(".fmu"):
        path = (relative_to / text).resolve()
        if not path.is_file():
            raise InputError(f"there is no FMU {path}")
        return path
    if ".py:" in text:
        file, _, class_name = text.rpartition(":")
        return _user_source((relative_to / file).resolve(), class_name, text)
    if text.endswith(".py"):
        raise InputError(_lacks_class((relative_to / text).resolve(), text))
    if text not in components().names():
        raise InputError(
            unknown("FMU", text, components().names())
            + "; or give a path: x.fmu, my_boat.py:Class, x.csv, x.toml of a log or a network"
        )
    return _indexed(text)


def _lacks_class(path: Path, text: str) -> str:
    """Return what to say of a file without a class: those that it has."""
    if not path.is_file():
        return f"{text}: there is no file {path}"
    try:
        tree = ast.parse(path.read_bytes(), filename=str(path))
    except (SyntaxError, ValueError) as error:
        return f"{text}: {error}"
    names = [node.name for node in tree.body if isinstance(node, ast.ClassDef) and node.bases]
    if not names:
        return f"{text}: a class is needed, as in {text}:Boat, and the file has none"
    return f"{text}: a class is needed: {' or '.join(f'{text}:{name}' for name in names)}"


def named_sources() -> dict[str, ComponentSource]:
    """Return the components of the index by FMU name: shipped, and of installed packages."""
    return {name: _indexed(name) for name in components().names()}


def shipped_sources() -> dict[str, ComponentSource]:
    """Return the shipped components by FMU name."""
    return {name: _indexed(name) for name in shipped_names()}


def _indexed(name: str) -> ComponentSource:
    module, _, class_name = components().target(name).partition(":")
    return ComponentSource(name, re.sub(r"\W", "_", name), module, class_name, name)


def _user_source(path: Path, class_name: str, written: str) -> ComponentSource:
    if not path.is_file():
        raise InputError(f"{written}: there is no file {path}")
    if not (path.stem.isidentifier() and class_name.isidentifier()):
        raise InputError(f"{written}: file and class must be Python identifiers: my_boat.py:Class")
    if path.stem in (*OURS, "pythonfmu") or path.stem in sys.stdlib_module_names:
        raise InputError(f"{written}: a file called {path.name} would hide a library; rename it")
    stem = f"{path.stem}_{class_name}"
    return ComponentSource(class_name, stem, path.stem, class_name, str(path), path.parent)


def _is_component(value: Any) -> bool:
    return isinstance(value, type) and issubclass(value, Component) and value is not Component


@contextmanager
def _importable(folder: Path) -> Iterator[None]:
    """Make modules in ``folder`` importable, and forget them again afterwards.

    Another folder may hold modules of the same names: those that are imported already step aside
    meanwhile. No bytecode is left there: Python takes it for current when a file is edited twice
    within a second.
    """
    hidden = _hidden_by(folder)
    for name in hidden:
        del sys.modules[name]
    before = set(sys.modules)
    wrote = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.dont_write_bytecode = wrote
        sys.path.remove(str(folder))
        for name in set(sys.modules) - before:
            if _is_in(sys.modules[name], folder):
                del sys.modules[name]
        sys.modules.update(hidden)


def _hidden_by(folder: Path) -> dict[str, ModuleType]:
    """Return the imported modules from elsewhere that have names of those in ``folder``."""
    listed: set[str] = set()
    with suppress(OSError):  # then Python finds nothing there either
        listed = {name.removesuffix(".py") for name in os.listdir(folder)}
    there = {
        top
        for top in (listed & sys.modules.keys()) - sys.stdlib_module_names
        if (folder / f"{top}.py").is_file() or (folder / top / "__init__.py").is_file()
    }
    if not there:
        return {}
    return {
        name: module
        for name, module in sys.modules.items()
        if name.partition(".")[0] in there and not _is_in(module, folder)
    }


def _is_in(module: ModuleType, folder: Path) -> bool:
    file = getattr(module, "__file__", None)
    return bool(file) and Path(str(file)).resolve().is_relative_to(folder.resolve())
