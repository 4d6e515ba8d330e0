"""Packages as an installer leaves them: a module, and metadata with entry points beside it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path


def installed(
    folder: Path, name: str, entry_points: Mapping[str, Mapping[str, str]], module: str = ""
) -> Path:
    """Install the package ``name`` with one module into ``folder``, which belongs on the path."""
    metadata = folder / f"{name}-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    lines: list[str] = []
    for group, names in entry_points.items():
        lines += [f"[{group}]", *(f"{key} = {target}" for key, target in names.items())]
    (metadata / "entry_points.txt").write_text("\n".join(lines) + "\n")
    (folder / f"{name}.py").write_text(module)
    return folder
