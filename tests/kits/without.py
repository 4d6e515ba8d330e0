"""Copies of the repository that lack kits, each in an environment whose metadata say so."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]
KITS = sorted(path.parent.name for path in ROOT.glob("src/seatrial_kits/*/kit.toml"))
_COPIED = (
    ".github",
    "src",
    "tests",
    "harness",
    "hil_profiles",
    "fmus",
    "docs",
    "examples",
    "benchmarks",
)


def without(folder: Path, kits: Iterable[str]) -> Path:
    """Return a copy below ``folder`` without these kits, with an environment in ``.venv``.

    The environment has the libraries of the one that runs, and the copy's own metadata.
    """
    copy = folder / "seatrial"
    ignored = shutil.ignore_patterns("__pycache__", "node_modules")
    for name in _COPIED:
        shutil.copytree(ROOT / name, copy / name, ignore=ignored)
    for path in ROOT.iterdir():
        if path.is_file():
            shutil.copy(path, copy)
    project = copy / "pyproject.toml"
    text = project.read_text("utf-8")
    for kit in kits:
        for place in ("src/seatrial_kits", "harness/kits", "tests/kits", "docs/kits"):
            shutil.rmtree(copy / place / kit, ignore_errors=True)
        text = re.sub(rf'^{kit} = "seatrial_kits\.{kit}"\n', "", text, flags=re.MULTILINE)
    project.write_text(text, "utf-8")
    venv.create(copy / ".venv", symlinks=True)
    paths = {"base": str(copy / ".venv"), "platbase": str(copy / ".venv")}
    site = Path(sysconfig.get_path("purelib", "venv", paths))
    # Named in a file, the other packages come after the copy's own; their editable ones do not.
    (site / "others.pth").write_text(sysconfig.get_path("purelib") + "\n", "utf-8")
    python = str(copy / ".venv/bin/python")
    install = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet"]
    install += ["--no-deps", "--editable", str(copy)]
    subprocess.run(install, check=True)
    return copy
