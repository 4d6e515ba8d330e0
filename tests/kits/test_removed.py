"""The core without kits: all removed at once, and each in turn, metadata written anew."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from .without import KITS, ROOT, without

pytestmark = pytest.mark.long
WHOLE = ("tests/interop", "tests/test_bibliography.py", "tests/test_docs.py")
WHOLE += ("tests/test_readme.py", "tests/test_wheel.py")
"""Tests of the whole: other people's tools, what all cite, pages, packages."""


NOTICING = ("tests/api", "tests/cli", "tests/cosim", "tests/kits/test_kits.py", "tests/links")
"""Where a kit that the core still knows of would be noticed; the others pass without any kit."""


def needing(kit: str) -> list[str]:
    """Return a kit with those whose manifests need it, or a kit that needs it."""
    files = {name: ROOT / "src/seatrial_kits" / name / "kit.toml" for name in KITS}
    needs = {
        name: tomllib.loads(p.read_text("utf-8")).get("needs", ()) for name, p in files.items()
    }
    gone = [kit]
    for lost in gone:  # grows on the way
        gone += [name for name in KITS if lost in needs[name] and name not in gone]
    return gone


def passes(python: str, folder: Path, *tests: str) -> None:
    command = [python, "-m", "pytest", "-n", "auto", "--tb=line", *tests]
    command += [f"--ignore={path}" for path in WHOLE]
    for chosen in ("not slow and not interop and not long", "not interop and not long"):
        done = subprocess.run([*command, "-m", chosen], cwd=folder, capture_output=True, text=True)
        if done.returncode != pytest.ExitCode.NO_TESTS_COLLECTED:  # some kits' tests are all slow
            break
    assert done.returncode == 0, done.stdout[-5000:]


@pytest.fixture
def _of_the_copy_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy's tests import the copy, wherever this run has its modules from."""
    monkeypatch.delenv("PYTHONPATH", raising=False)


@pytest.mark.usefixtures("_of_the_copy_alone")
def test_the_core_passes_its_tests_without_any_kit(tmp_path: Path) -> None:
    copy = without(tmp_path, KITS)
    passes(str(copy / ".venv/bin/python"), copy, "tests")


@pytest.mark.usefixtures("_of_the_copy_alone")
@pytest.mark.parametrize("kit", KITS)
def test_the_core_does_not_notice_that_one_is_gone(kit: str, tmp_path: Path) -> None:
    copy = without(tmp_path, needing(kit))
    doctor = subprocess.run([copy / ".venv/bin/seatrial", "doctor"], capture_output=True, text=True)
    assert kit not in doctor.stdout.partition("kits:")[2].partition("\n")[0]
    passes(str(copy / ".venv/bin/python"), copy, *NOTICING)


@pytest.mark.parametrize("kit", KITS)
def test_a_kits_own_tests_pass_alone(kit: str) -> None:
    if (ROOT / "tests/kits" / kit).is_dir():
        passes(sys.executable, ROOT, f"tests/kits/{kit}")
