"""Where an FMU comes from: a shipped name, an ``.fmu`` file, or ``my_boat.py:Class``."""

from __future__ import annotations

import ast
import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from ..component import Component
from ..errors import InputError, unknown
from ..shipped import shipped_folder

_SCRIPT = '''"""{name}: {class_name} of {file} as an FMU."""

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
    script: bytes
    """The slave script's text."""
    folder: Path
    """Where the modules beside the script are."""
    origin: str
    """What the user wrote or where the script is, for messages."""

    def slave_class(self) -> type[Any]:
        """Return the script's slave class, from the modules as they lie on disk.

        Raises InputError if the script cannot be imported.
        """
        with _importable(self.folder):
            module = ModuleType(self.stem)
            try:
                exec(compile(self.script, f"{self.stem}.py", "exec"), module.__dict__)
            except InputError:
                raise
            except Exception as error:
                raise InputError(
                    f"{self.origin}: cannot be imported: {type(error).__name__}: {error}"
                ) from error
        from .slave import Slave

        found = [
            v
            for v in vars(module).values()
            if isinstance(v, type) and issubclass(v, Slave) and v is not Slave
        ]
        if len(found) != 1:
            raise InputError(f"{self.origin}: has {len(found)} subclasses of Slave, one is needed")
        if "__init__" not in vars(found[0]):
            raise InputError(
                f"{self.origin}: {found[0].__name__} needs an __init__ of its own: pythonfmu's "
                "binary releases the script's globals unless a function defined there holds them"
            )
        return found[0]

    def component_class(self) -> type[Component]:
        """Return the component class behind the slave; raises InputError as `slave_class`."""
        cls = getattr(self.slave_class(), "component_class", None)
        if not (isinstance(cls, type) and issubclass(cls, Component)):
            raise InputError(f"{self.origin}: {cls!r} is not a subclass of seatrial's Component")
        return cls

    @property
    def title(self) -> str:
        """Return the first line of the component's description, without importing it."""
        for node in ast.parse(self.script).body:
            if isinstance(node, ast.ImportFrom) and node.module != "seatrial.fmi.slave":
                return _class_title(node.module or "", node.names[0].name)
        return ""


def _class_title(module: str, name: str) -> str:
    spec = importlib.util.find_spec(module)
    tree = ast.parse(Path(str(spec.origin)).read_bytes()) if spec else ast.Module([], [])
    found = (n for n in tree.body if isinstance(n, ast.ClassDef) and n.name == name)
    return next(((ast.get_docstring(n) or "").partition("\n")[0] for n in found), "")


def find_source(text: str, relative_to: Path) -> ComponentSource | Path:
    """Return what ``text`` names: a component, or the path of an ``.fmu`` file.

    ``text`` is ``path/to/x.fmu``, ``path/to/my_boat.py:Class`` (both relative to the file that
    says it) or the name of a shipped FMU. Raises InputError if there is nothing there.
    """
    if text.endswith(".fmu"):
        path = (relative_to / text).resolve()
        if not path.is_file():
            raise InputError(f"there is no FMU {path}")
        return path
    if ".py:" in text:
        file, _, class_name = text.rpartition(":")
        return _user_source((relative_to / file).resolve(), class_name, text)
    shipped = shipped_sources()
    if text not in shipped:
        raise InputError(
            unknown("FMU", text, shipped) + "; or give a path: x.fmu, my_boat.py:Class"
        )
    return shipped[text]


def shipped_sources() -> dict[str, ComponentSource]:
    """Return the shipped components by FMU name."""
    sources = {}
    for path in sorted(shipped_folder("fmus").glob("*.py")):
        name = path.stem.replace("_", "-")
        sources[name] = ComponentSource(name, path.stem, path.read_bytes(), path.parent, str(path))
    return sources


def _user_source(path: Path, class_name: str, written: str) -> ComponentSource:
    if not path.is_file():
        raise InputError(f"{written}: there is no file {path}")
    if not (path.stem.isidentifier() and class_name.isidentifier()):
        raise InputError(f"{written}: file and class must be Python identifiers: my_boat.py:Class")
    if path.stem in ("seatrial", "pythonfmu") or path.stem in sys.stdlib_module_names:
        raise InputError(f"{written}: a file called {path.name} would hide a library; rename it")
    script = _SCRIPT.format(
        name=class_name, class_name=class_name, file=path.name, module=path.stem
    )
    stem = f"{path.stem}_{class_name}"
    return ComponentSource(class_name, stem, script.encode(), path.parent, str(path))


@contextmanager
def _importable(folder: Path) -> Iterator[None]:
    """Make modules in ``folder`` importable, and forget them again afterwards.

    Another user's folder may hold files of the same names. No bytecode is left there: Python
    takes it for current when a file is edited twice within a second.
    """
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
            file = getattr(sys.modules[name], "__file__", None)
            if file and Path(file).resolve().is_relative_to(folder.resolve()):
                del sys.modules[name]
