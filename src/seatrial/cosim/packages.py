"""Whole systems in files of other tools: SSP packages, and OSP-IS' system structures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .packaged import OSP_FILE, PackagedSystem


def is_package(name: str, relative_to: Path | None = None) -> bool:
    """Say if ``name`` is a package: ``x.ssp``, ``x.xml``, or a folder with an `OSP_FILE`."""
    if name.endswith((".ssp", ".xml")):
        return True
    return ((relative_to or Path.cwd()) / name / OSP_FILE).is_file()


def read_package(path: Path, changes: Mapping[str, Any]) -> PackagedSystem:
    """Read the package at ``path``; ``changes`` may have another step for it.

    Raises InputError naming file and line.
    """
    # Both need an XML library and FMPy.
    if path.suffix == ".ssp":
        from .ssp.reading import read_ssp

        return read_ssp(path, changes.get("step"))
    from .osp.reading import read_osp

    return read_osp(path, changes.get("step"))
