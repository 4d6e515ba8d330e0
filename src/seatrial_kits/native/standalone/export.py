"""Python components to FMUs that carry Python: libpython, standard library and packages."""

from __future__ import annotations

import platform
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.fmi.building.bundle import bundled
from seatrial.fmi.building.export import fmu_files
from seatrial.fmi.building.packing import zipped
from seatrial.fmi.cache import write_named
from seatrial.fmi.compiler import TUPLES, library_here
from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.forwarding.libraries import pythonfmu_libraries
from seatrial.fmi.forwarding.sources import checked_sources
from seatrial.fmi.libpython import find_libpython
from seatrial.model.component import Component

from .distribution import compiled, distributions, files_of, standard_library
from .shared_objects import least_glibc, needed

_PLATFORM = "linux64"
_HOME = "resources/python"
_LAUNCHER = "libpythonfmu-export.so"
_VERSION = f"{sys.version_info.major}.{sys.version_info.minor}"


def build_standalone_fmu(
    source: ComponentSource,
    destination: Path,
    start_values: Mapping[str, Any] | None = None,
    version: int = 2,
) -> str:
    """Build the standalone FMU of ``source`` at ``destination``; return the glibc that it needs.

    It runs on Linux on x86-64 with this glibc or a newer one, and needs nothing else there. Where
    a Python is in the process already, that one is used, with its packages first. Raises
    InputError where it cannot be built: on another machine, without libpython or a C compiler,
    for a distribution that is not installed; nothing is written then.
    """
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        raise InputError("standalone FMUs are built on, and for, Linux on x86-64")
    if find_libpython() is None:
        raise InputError(
            f"a standalone FMU carries libpython {_VERSION}, and this machine has none; "
            f"on Debian: apt install libpython{_VERSION}"
        )
    carried = {**_python(), **_packages(source)}
    carried |= _libraries(carried)
    inside = {f"{_HOME}/{name}": data for name, data in carried.items()}
    folder = TUPLES[_PLATFORM] if version == 3 else _PLATFORM
    inside[f"binaries/{folder}/{source.stem}.so"] = _launcher(
        version, source.component_class()(source.name)
    )
    files = fmu_files(source, start_values, inside, version)
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, zipped(files))
    return least_glibc(data for name, data in files.items() if ".so" in name)


def _python() -> dict[str, bytes]:
    """Return libpython, the standard library and pythonfmu's library, by path in Python's home."""
    libpython = find_libpython()
    assert libpython is not None
    files = {
        f"lib/{libpython.name}": libpython.read_bytes(),
        f"lib/{_LAUNCHER}": pythonfmu_libraries()[_PLATFORM].read_bytes(),
    }
    for name, data in standard_library():
        files |= _with_bytecode(f"lib/{name}", data)
    return files


def _packages(source: ComponentSource) -> dict[str, bytes]:
    """Return the distributions that the component needs, by path in Python's home."""
    files: dict[str, bytes] = {}
    for distribution in distributions(bundled(source).requirements).values():
        for name, data in files_of(distribution):
            files |= _with_bytecode(f"site-packages/{name}", data)
    return files


def _with_bytecode(path: str, data: bytes) -> dict[str, bytes]:
    bytecode = compiled(path, data)
    return {path: data} if bytecode is None else {path: data, bytecode[0]: bytecode[1]}


def _libraries(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the other libraries that those of ``files`` need, and the list of them."""
    with tempfile.TemporaryDirectory() as folder:
        placed = []
        for name, data in files.items():
            if ".so" in name:
                path = Path(folder).resolve() / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
                placed.append(path)
        found = needed(placed, Path(folder).resolve())
        listed = {f"lib/{name}": path.read_bytes() for name, path in found.items()}
    return {**listed, "lib/libraries.txt": "".join(f"{name}\n" for name in found).encode()}


def _launcher(version: int, component: Component) -> bytes:
    libpython = find_libpython()
    assert libpython is not None
    defined = {
        "PYTHON_VERSION": _VERSION,
        "PYTHON_LIBRARY": libpython.name,
        "FMU_LIBRARY": _LAUNCHER,
    }
    lines = "".join(f'#define {name} "{value}"\n' for name, value in defined.items())
    sources = {
        **checked_sources(version, component),
        "launcher.c": Path(__file__).with_name("launcher.c").read_bytes(),
        "python.h": lines.encode(),
    }
    return library_here(sources, _PLATFORM, ("-ldl", "-lpthread"))
