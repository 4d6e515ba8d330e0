"""Whole systems in files of other tools: SSP packages, and OSP-IS' system structures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .packaged import OSP_FILE, SSP_FILE, PackagedSystem


def is_package(name: str, relative_to: Path | None = None) -> bool:
    """Say if ``name`` is a package: .ssp, .ssd, .xml, or a folder with one's description."""
    if name.endswith((".ssp", ".ssd", ".xml")):
        return True
    folder = (relative_to or Path.cwd()) / name
    return any((folder / file).is_file() for file in (OSP_FILE, SSP_FILE))


def read_package(path: Path, changes: Mapping[str, Any]) -> PackagedSystem:
    """Read the package at ``path``; ``changes`` may have another step for it.

    A folder with both descriptions is OSP's, as libcosim has it. Raises InputError naming file
    and line.
    """
    # Both need an XML library and FMPy.
    is_osp = path.suffix == ".xml" or (path / OSP_FILE).is_file()
    if is_osp:
        from .osp.reading import read_osp

        return read_osp(path, changes.get("step"))
    from .ssp.reading import read_ssp

    return read_ssp(path, changes.get("step"))
