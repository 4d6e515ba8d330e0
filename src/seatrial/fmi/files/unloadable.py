"""The reason why a shared library is not loaded, from the words of glibc's dlopen."""

from __future__ import annotations

import re

_MISSING = re.compile(r"(?:^|\s)([^\s/:]+\.so[.\d]*): cannot open shared object file")
_VERSION = re.compile(r"\S*?([^\s/:]+): version `([^']+)' not found")
_SYMBOL = re.compile(r"undefined symbol: ([^\s,]+)")
_NAME = re.compile(r"(lib.+?)\.so\.?(.*)")
_PACKAGES = {
    "libgfortran.so.3": "libgfortran3, which Debian has up to 9 and Ubuntu up to 18.04",
    "libcrypto.so.1.0.0": "libssl1.0.0",
    "libcrypto.so.1.1": "libssl1.1",
    "libcrypto.so.3": "libssl3",
}


def reason(error: Exception) -> str:
    """Return which library or symbol is missing, and what to install; else what was said."""
    said = str(error)
    if found := _MISSING.search(said):
        name = found[1]
        return f"it needs the shared library {name}, which is not installed{_package(name)}"
    if found := _VERSION.search(said):
        return f"it needs {found[1]} of a newer version, one that has {found[2]}"
    if found := _SYMBOL.search(said):
        return f"it needs the symbol {found[1]}, which none of its libraries has"
    return said


def _package(library: str) -> str:
    """Return where Debian has a library; its packages are called after name and version."""
    if library in _PACKAGES:
        return f" (package {_PACKAGES[library]})"
    name = _NAME.fullmatch(library)
    if name is None or not name[2]:
        return ""
    if name[1].startswith("libpython"):
        return f" (package {name[1]})"
    hyphen = "-" if name[1][-1].isdigit() else ""
    package = f"{name[1]}{hyphen}{name[2]}".lower().replace("_", "-")
    return f" (on Debian and Ubuntu most likely package {package})"
