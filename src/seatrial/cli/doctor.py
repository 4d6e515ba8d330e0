"""``seatrial doctor``: what is missing on this machine, and how to load a Python FMU."""

from __future__ import annotations

import importlib.metadata
import platform
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path

import typer
from rich.markup import escape

from ..errors import InputError
from ..fmi.cache import cache_folder, is_safe
from ..fmi.libpython import find_libpython
from ..kits import MANIFEST, OURS, kits
from .answer import answer
from .show import console

_TOP = Path(__file__).parents[2]
_PLATFORMS = {("Linux", "x86_64"), ("Windows", "AMD64")}


def doctor() -> None:
    """Check this machine: working parts, missing parts, and remedies."""
    checks: list[tuple[str, Callable[[], tuple[bool, str]]]] = [
        ("Python", _python),
        ("platform", _platform),
        ("packages", _packages),
        ("kits", kits_here),
        ("FMU cache", _cache),
        ("libpython", _libpython),
    ]
    missing = 0
    for name, check in checks:
        good, text = check()
        missing += not good
        answer.result.setdefault("checks", []).append({"name": name, "ok": good, "text": text})
        mark = "[green]ok[/green]     " if good else "[red]missing[/red]"
        console.print(f"{mark}  {name}: {escape(text)}", soft_wrap=True)
    answer.result["preload"] = preload_line()
    console.print("\nTo load a Python FMU in a program without Python, start it as:")
    console.print(f"  {preload_line()} PROGRAM", soft_wrap=True, markup=False)
    if missing:
        raise typer.Exit(1)


def preload_line() -> str:
    """Return the environment that lets a program without Python load a Python FMU."""
    library = find_libpython()
    packages = sysconfig.get_path("purelib")
    return f"LD_PRELOAD={library or 'libpython3.x.so (not found)'} PYTHONPATH={packages}"


def _python() -> tuple[bool, str]:
    return sys.version_info >= (3, 11), f"{platform.python_version()} in {sys.prefix}"


def _platform() -> tuple[bool, str]:
    here = (platform.system(), platform.machine())
    text = f"{here[0]} {here[1]}"
    if here in _PLATFORMS:
        return True, text
    return False, f"{text}: Python FMUs have binaries for Linux and Windows on x86-64 only"


def _packages() -> tuple[bool, str]:
    wanted = ("casadi", "fmpy", "numpy", "pint", "pydantic", "pythonfmu", "scipy")
    found, lacking = [], []
    for name in wanted:
        try:
            found.append(f"{name} {importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            lacking.append(name)
    if lacking:
        return False, f"install with  {sys.executable} -m pip install {' '.join(lacking)}"
    return True, ", ".join(found)


def kits_here() -> tuple[bool, str]:
    """Return if all kits can be used, and which there are, or what is wrong with others."""
    installed = kits()
    unwritten = sorted(
        {path.parent.name for path in _TOP.glob(f"{OURS[1]}/*/{MANIFEST}")}
        - {kit.name for kit in installed.found}
        - set(installed.left_out)
    )
    wrong = [f"{name} is left out: {why}" for name, why in installed.left_out.items()]
    wrong += [f"{name} is new: install seatrial again for its entry point" for name in unwritten]
    return not wrong, "; ".join(wrong) or ", ".join(kit.name for kit in installed.found) or "none"


def _cache() -> tuple[bool, str]:
    try:
        folder = cache_folder("fmus").parent
    except (InputError, OSError) as error:
        return False, str(error)
    return is_safe(folder), str(folder)


def _libpython() -> tuple[bool, str]:
    library = find_libpython()
    if library is None:
        version = f"{sys.version_info.major}.{sys.version_info.minor}"
        return False, f"none for Python {version}; on Debian: apt install libpython{version}"
    return True, str(library)
