"""Shared fixtures. Everything that tests write goes below pytest's temporary folder."""

from __future__ import annotations

import gc
import os
import re
import signal
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings

from seatrial.fmi.building.bundle import bundled
from seatrial.fmi.components.source import shipped_sources
from seatrial.model.units import unit
from tests.fmi.native import build_native_fmu

if hasattr(signal, "SIGHUP"):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # tests send it, also when nohup runs them

# A busy machine is no failure; other examples are tried in every run.
settings.register_profile("any-machine", settings(), deadline=None, max_examples=30)
settings.load_profile("any-machine")


_ROOT = Path(__file__).parents[1]
_OF_KITS = re.compile(
    r"^(?:from|import) (?:seatrial_kits|(?:tests|\.)\.kits)\.(\w+)[. ]", re.MULTILINE
)


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out the tests of the core that use a kit which is not here."""
    if collection_path.suffix != ".py":
        return None
    for kit in _OF_KITS.findall(collection_path.read_text("utf-8")):
        if not (_ROOT / "src/seatrial_kits" / kit).is_dir():
            return True
    return None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let a case in so many of a `sampled` test stay; the others are slow, or long if it is slow."""
    cases: Counter[str] = Counter()
    for item in items:
        mark = item.get_closest_marker("sampled")
        if mark is None:
            continue
        test = item.nodeid.partition("[")[0]
        if cases[test] % mark.args[0]:
            is_slow = any(item.get_closest_marker(name) for name in ("slow", "interop"))
            item.add_marker(pytest.mark.long if is_slow else pytest.mark.slow)
        cases[test] += 1


def pytest_collection_finish() -> None:
    """Leave what was imported and collected, which stays, out of every look for garbage."""
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def _cache(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep built and unpacked FMUs out of the user's cache; workers of one run share them."""
    base = tmp_path_factory.getbasetemp()
    if os.environ.get("PYTEST_XDIST_WORKER"):
        base = base.parent
    os.environ["SEATRIAL_CACHE"] = str(base / "seatrial-cache")


@pytest.fixture(scope="session", autouse=True)
def _begun() -> None:
    """Do what most runs begin with: each goes on in a copy of this process, which has it then."""
    unit("furlong")  # makes the registry of units
    bundled(shipped_sources()["marine-craft"])  # reads and parses the modules of a plant


@pytest.fixture
def write(tmp_path: Path):
    """Return a function that writes a file below the test's folder and returns its path."""

    def write(name: str, text: str) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
        return path

    return write


@pytest.fixture(scope="session")
def native_fmu(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a function that compiles ``tests/fmi/slaves/NAME.c`` into an FMU, once a session."""
    folder = tmp_path_factory.mktemp("native")
    return cache(lambda name: build_native_fmu(name, folder))
