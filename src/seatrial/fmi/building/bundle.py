"""Bundle of an FMU: its script and the import closure of it, under names of their own.

All FMUs of a process share one interpreter and one ``sys.modules``. So everything bundled lives
in one package whose name carries the hash of its content, and the script's name carries it
too: FMUs of different versions, or of different users with files of the same name, never run
each other's code.

A module that reads data files names them in a constant, ``DATA_FILES = ("polar.csv",)``; they
lie beside it, it reads them from ``Path(__file__).with_name("polar.csv")``, and they travel.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.metadata
import importlib.util
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path

from ...errors import InputError
from ...kits import OURS
from ...moved import moved_to
from ..components.source import ComponentSource
from .imports import imports, parsed, renamed

_NO_INIT = b'"""Part of pythonfmu (MIT licence, beside this file)."""\n'


@dataclass(frozen=True)
class Bundle:
    """Files for an FMU's ``resources`` by relative path, and the name of its script."""

    script: str
    requirements: tuple[str, ...]
    """Third-party distributions that the files import, as pip requirements."""
    read: tuple[Path, ...]
    """The modules and data files that it is made of, as they lie on disk."""
    write: Callable[[], dict[str, bytes]]

    @cached_property
    def files(self) -> dict[str, bytes]:
        """Contents by path; written when asked for, as a run in process needs the name alone."""
        return self.write()


def bundled(source: ComponentSource) -> Bundle:
    """Bundle a component's slave script; see `bundle`."""
    return bundle(source.stem, source.script, source.folder, source.package)


def bundle(stem: str, source: bytes, folder: Path | None, package: str | None = None) -> Bundle:
    """Bundle a slave script with all it imports from seatrial, pythonfmu and of its own.

    ``source`` is the script's text, ``stem`` its name. Its own are the modules in ``folder``,
    and those of the installed ``package``, wherever they are imported. Of seatrial's own
    modules, imports inside functions are left out: what they bring is for builds and tools.

    Raises InputError for a file that is not Python, an import that is found nowhere or a data
    file that is not there.
    """
    local = _Local(folder, package)
    modules, third_party = _closure(source, f"{stem}.py", local)
    digest = hashlib.sha256()
    data: dict[str, bytes] = {}
    read = [path for path, _ in modules.values()]
    for name, (path, text) in sorted(modules.items()):
        digest.update(f"{name}\0{path.name}\0".encode() + text + b"\0")
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for file, content in _data_files(path, text):
            digest.update(f"{file}\0{len(content)}\0".encode() + content)
            data["/".join([*package.split("."), file] if package else [file])] = content
            read.append(path.with_name(file))
    needed = {name: _requirement(name) for name in sorted(third_party)}
    requirements = tuple(needed.values())
    digest.update(stem.encode() + b"\0" + source + "\0".join(requirements).encode())
    tag = digest.hexdigest()[:12]

    def write() -> dict[str, bytes]:
        root = f"bundle_{tag}"
        own = frozenset(name.partition(".")[0] for name in modules)
        files = {f"{root}/__init__.py": _preflight(stem, needed)}
        files |= {f"{root}/{place}": content for place, content in data.items()}
        for name, (path, text) in modules.items():
            end = "/__init__.py" if path.name == "__init__.py" else ".py"
            place = name.replace(".", "/") + end
            files[f"{root}/{place}"] = renamed(text, str(path), own, root)
        if "pythonfmu" in own:
            files[f"{root}/pythonfmu/LICENSE"] = _pythonfmu_licence()
        files[f"{stem}_{tag}.py"] = renamed(source, f"{stem}.py", own, root)
        files["slavemodule.txt"] = f"{stem}_{tag}".encode()
        files["requirements.txt"] = "".join(f"{r}\n" for r in requirements).encode()
        return files

    return Bundle(f"{stem}_{tag}", requirements, tuple(read), write)


class _Local:
    """Finds the modules that travel: seatrial's, pythonfmu's and the component's own."""

    def __init__(self, folder: Path | None, package: str | None) -> None:
        self.folder = folder
        self.ours = {name: _package(name) for name in (*OURS, "pythonfmu")}
        self.roots = self.ours if package is None else {**self.ours, package: _package(package)}
        self.find = cache(self._find)  # most modules import the same few others

    def _find(self, name: str) -> Path | None:
        """Return the file of module ``name``, None if it is not one that travels."""
        top, *rest = name.split(".")
        if top in self.roots:
            return _package_file(self.roots[top], *rest)
        return None if self.folder is None else _module_file(self.folder / top, *rest)

    def is_namespace(self, name: str) -> bool:
        """Say if ``name`` is a folder beside the script without an ``__init__.py``."""
        if self.folder is None or "." in name:
            return False
        return (self.folder / name).is_dir() and self.find(name) is None


def _module_file(base: Path, *rest: str) -> Path | None:
    path = base.joinpath(*rest)
    for candidate in (path / "__init__.py", path.with_suffix(".py")):
        if candidate.is_file():
            return candidate
    return None


# A rig asks for the same hundred modules once per component, and packages stay as installed.
_package_file = lru_cache(maxsize=4096)(_module_file)


def _package(name: str) -> Path:
    """Return where an installed package lies: its folder, or its one module without ``.py``."""
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None:
        raise InputError(
            f"the package {name!r} cannot travel in an FMU: "
            + ("it is not installed" if spec is None else "it needs an __init__.py")
        )
    origin = Path(spec.origin)
    return origin.parent if spec.submodule_search_locations else origin.with_suffix("")


def _closure(
    source: bytes, file: str, local: _Local
) -> tuple[dict[str, tuple[Path, bytes]], set[str]]:
    """Return the travelling modules by name, and the third-party packages they import."""
    modules: dict[str, tuple[Path, bytes]] = {}
    third_party: set[str] = set()
    todo = [(found, file) for found in imports(source, file, "", False, everywhere=True)]
    while todo:
        (name, optional), importer = todo.pop()
        path = local.find(name)
        new = None if path else moved_to(name)
        if new and (path := local.find(new)) and name not in modules:
            modules[name] = path, _moved(new)
            todo += [((one, False), importer) for one in (new, name.rpartition(".")[0])]
            continue
        if path is None:
            top = name.partition(".")[0]
            if local.find(top) is None and top not in sys.stdlib_module_names and not optional:
                _require_installed(top, importer, local)
                third_party.add(top)
            continue
        if name in modules:
            continue
        text = path.read_bytes()
        if name == "pythonfmu":
            text = _NO_INIT  # its __init__ imports the builder, which an FMU does not need
        modules[name] = (path, text)
        package = path.name == "__init__.py"
        own = name.partition(".")[0] not in local.ours
        found = imports(text, str(path), name, package, everywhere=own)
        todo += [(one, str(path)) for one in found]
        if "." in name:
            todo.append(((name.rpartition(".")[0], False), str(path)))
    return modules, third_party


def _moved(new: str) -> bytes:
    """Return a module by the path that it had: the one of the path that it has."""
    package, _, leaf = new.rpartition(".")
    return (
        f'"""Now {new}."""\n\nimport sys\n\nfrom {package} import {leaf}\n\n'
        f"sys.modules[__name__] = {leaf}\n"
    ).encode()


def _data_files(path: Path, source: bytes) -> list[tuple[str, bytes]]:
    """Return name and content of the files that the module at ``path`` says it reads."""
    found = []
    for name in _data_names(source, str(path)):
        file = path.with_name(name)
        if not file.is_file():
            raise InputError(f"{path}: DATA_FILES names {name!r}, and there is no such file there")
        found.append((name, file.read_bytes()))
    return found


@lru_cache(maxsize=1024)
def _data_names(source: bytes, file: str) -> tuple[str, ...]:
    """Return what a module assigns to ``DATA_FILES`` at its top level."""
    for node in parsed(source, file).body:
        if not isinstance(node, (ast.Assign, ast.AnnAssign)):
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        if not any(isinstance(t, ast.Name) and t.id == "DATA_FILES" for t in targets):
            continue
        try:
            names = ast.literal_eval(node.value or "")
        except (ValueError, TypeError, SyntaxError):
            names = None
        if not isinstance(names, (tuple, list)) or not all(map(_is_plain_name, names)):
            raise InputError(
                f"{file}, line {node.lineno}: DATA_FILES must be a tuple of names of files beside "
                'the module, written out: ("polar.csv",)'
            )
        return tuple(names)
    return ()


def _is_plain_name(name: object) -> bool:
    return isinstance(name, str) and Path(name).name == name != "" and not name.endswith(".py")


def _require_installed(top: str, importer: str, local: _Local) -> None:
    if local.is_namespace(top):
        raise InputError(f"{importer}: imports {top!r}, a folder without an __init__.py; add one")
    if importlib.util.find_spec(top) is None:
        raise InputError(
            f"{importer}: imports {top!r}, which is not installed"
            + (f" and no module beside it in {local.folder}" if local.folder else "")
        )


@cache
def _requirement(package: str) -> str:
    """Return the pip requirement of an imported package, with seatrial's own bounds on it."""
    bounds = _bounds()
    if package in bounds:
        return bounds[package]
    distribution = min(_distributions().get(package, [package]))
    return bounds.get(distribution.lower(), distribution)


_OF_DEVELOPERS = ("dev", "docs", "fuzz")
"""Extras whose bounds are none of seatrial's own."""


@cache
def _bounds() -> dict[str, str]:
    """Return seatrial's own requirements by the names of the distributions."""
    lines = [
        line.partition(";")[0].strip()
        for line in importlib.metadata.requires("seatrial") or []
        if not any(f'extra == "{extra}"' in line for extra in _OF_DEVELOPERS)
    ]
    return {found[0].lower(): line for line in lines if (found := re.match(r"[\w.-]+", line))}


@cache  # it reads the lists of files of everything that is installed
def _distributions() -> Mapping[str, list[str]]:
    return importlib.metadata.packages_distributions()


def _preflight(stem: str, needed: dict[str, str]) -> bytes:
    """Return the bundle's ``__init__``: it names what the target machine lacks."""
    return f'''"""Code and data of the FMU {stem}; its name carries the hash of its content."""

import importlib.util
import sys

_needed = {needed!r}
_missing = {{p: r for p, r in _needed.items() if importlib.util.find_spec(p) is None}}
if _missing:
    _message = (
        "the FMU {stem} needs the Python package(s) " + ", ".join(_missing) + " in "
        + sys.prefix + ": install them with  python3 -m pip install "
        + " ".join(chr(34) + r + chr(34) for r in _missing.values())
    )
    print(_message, file=sys.stderr)  # a host with logging off would lose it
    raise ImportError(_message)
'''.encode()


def _pythonfmu_licence() -> bytes:
    for file in importlib.metadata.files("pythonfmu") or []:
        if file.name == "LICENSE":
            return file.read_binary()
    return b"MIT License; see the pythonfmu distribution.\n"
