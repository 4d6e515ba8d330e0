"""Whole systems in files of other tools: SSP packages, and OSP-IS' system structures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..plugins import service
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
    is_osp = path.suffix == ".xml" or (path / OSP_FILE).is_file()
    read: Callable[[Path, Any], PackagedSystem] = service(
        "interchange.read_osp" if is_osp else "interchange.read_ssp"
    )
    return read(path, changes.get("step"))
