"""Folders shipped with the library: fmus, harness, hil_profiles, vehicles."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent
_CHECKOUT = _PACKAGE.parents[1]


def shipped_folder(name: str) -> Path:
    """Return the shipped folder ``name``: in the wheel, or at the top of a checkout."""
    installed = _PACKAGE / "_shipped" / name
    if installed.is_dir():
        return installed
    if name == "vehicles":
        return _PACKAGE / name
    return _CHECKOUT / name


def searched_folders(kind: str) -> list[Path]:
    """Return the folders where files of ``kind`` are looked for, in order."""
    top, _, below = kind.partition("/")
    shipped = shipped_folder(top) / below if below else shipped_folder(top)
    return [p for p in dict.fromkeys([Path.cwd() / kind, shipped]) if p.is_dir()]


def available(kind: str) -> dict[str, Path]:
    """Return the files of ``kind`` by name, the ones that `find_file` of `cosim.files` returns."""
    found: dict[str, Path] = {}
    for folder in searched_folders(kind):
        for path in sorted(folder.glob("*.toml")):
            found.setdefault(path.stem, path)
    return dict(sorted(found.items()))
