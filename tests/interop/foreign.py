"""Collections of FMUs of others: fetched once, outside the repository, at the commits named here."""

from __future__ import annotations

import os
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

GITHUB = "https://github.com"
KEPT = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "seatrial-foreign-fmus"


@dataclass(frozen=True)
class Collection:
    """A repository with FMUs in it, or with the sources of some for each version of FMI."""

    repository: str
    commit: str
    fmus: tuple[str, ...] = ()
    """What is checked out, in the syntax of .gitignore: all, if this is empty."""
    builds: tuple[str, ...] = ()
    """Options of CMake, one build for each."""


COLLECTIONS = {
    # Release 0.0.30: later ones have no FMI 1.0.
    "reference-fmus-1": Collection(
        "modelica/Reference-FMUs", "477a3542815abf3c57ff2032ab9e4155ec42a2e2",
        builds=("-DFMI_VERSION=1 -DFMI_TYPE=CS", "-DFMI_VERSION=1 -DFMI_TYPE=ME"),
    ),
    "reference-fmus": Collection(
        "modelica/Reference-FMUs", "1258711a41e28b1c25e058abd04f6214beefa3cb",
        builds=("-DFMI_VERSION=2", "-DFMI_VERSION=3"),
    ),
    "libcosim": Collection(
        "open-simulation-platform/libcosim", "52cc82513d3099df3c1c91eeb980227db52c70cf", ("/tests/data/fmi1/", "/tests/data/fmi2/", "/tests/data/msmi/")
    ),
    "demo-cases": Collection("open-simulation-platform/demo-cases", "406ccab659b582abf36a2b6a6dac270ff3ab3456",
        ("*.fmu", "*.xml"),
    ),
    "ecos": Collection("Ecos-platform/ecos", "cdfdeb2cb25db39c867f9e3c922c7ab0b26b76d4", ("/data/fmus/",)),
    "fmpy": Collection("CATIA-Systems/FMPy", "e8b71b702fb4a5b6b63db9ef934f6dbb29816be6", ("/tests/resources/",)),
    "omsimulator": Collection("OpenModelica/OMSimulator", "2940ef11c2316c167bc78618d89de085b7cac52f", ("/testsuite/tests/resources/",)),
}  # fmt: skip


@cache
def collection(name: str) -> Path:
    """Return the folder with the FMUs of a collection; fetched and built if they are not there.

    Fails with all that was said if that cannot be.
    """
    wanted = COLLECTIONS[name]
    folder = KEPT / f"{name}-{wanted.commit}"
    if not folder.is_dir():
        with tempfile.TemporaryDirectory(prefix=".", dir=_made(KEPT)) as begun:
            _fetch(wanted, Path(begun) / "it")
            (Path(begun) / "it").rename(folder)
    return folder


def _fetch(wanted: Collection, folder: Path) -> None:
    _run("git", "init", "--quiet", str(folder))
    if wanted.fmus:
        _run("git", "sparse-checkout", "set", "--no-cone", *wanted.fmus, folder=folder)
    _run("git", "remote", "add", "origin", f"{GITHUB}/{wanted.repository}", folder=folder)
    fetch = ("git", "fetch", "--quiet", "--depth=1", "--filter=blob:none", "origin")
    _run(*fetch, wanted.commit, folder=folder)
    _run("git", "checkout", "--quiet", "--force", "FETCH_HEAD", folder=folder)
    for i, options in enumerate(wanted.builds):
        build = folder / f"build{i}"
        _run("cmake", "-S", str(folder), "-B", str(build), *options.split())
        _run("cmake", "--build", str(build), "--parallel", str(os.cpu_count() or 1))


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _run(*command: str, folder: Path | None = None) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}"
