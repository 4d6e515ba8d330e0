"""The core without kits: all removed at once, and each in turn, metadata written anew."""

from __future__ import annotations

import subprocess
import tomllib
from pathlib import Path

import pytest

from .without import KITS, ROOT, without

pytestmark = pytest.mark.long
WHOLE = ("tests/interop", "tests/test_docs.py", "tests/test_readme.py", "tests/test_wheel.py")
"""Tests of the whole: other people's tools, pages, packages."""


NOTICING = ("tests/api", "tests/cli", "tests/cosim", "tests/kits/test_kits.py", "tests/links")
"""Where a kit that the core still knows of would be noticed; the others pass without any kit."""


def needing(kit: str) -> list[str]:
    """Return a kit with those whose manifests need it, or a kit that needs it."""
    needs = {
        name: tomllib.loads(
            (ROOT / "src/seatrial_kits" / name / "kit.toml").read_text("utf-8")
        ).get("needs", ())
        for name in KITS
    }
    gone = [kit]
    for lost in gone:  # grows on the way
        gone += [name for name in KITS if lost in needs[name] and name not in gone]
    return gone


def passes(copy: Path, *tests: str) -> None:
    python = str(copy / ".venv/bin/python")
    ignored = [f"--ignore={path}" for path in WHOLE]
    command = [python, "-m", "pytest", "-n", "auto", "-m", "not slow and not interop and not long"]
    done = subprocess.run(
        [*command, *ignored, "--tb=line", *tests], cwd=copy, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-5000:]


def test_the_core_passes_its_tests_without_any_kit(tmp_path: Path) -> None:
    passes(without(tmp_path, KITS), "tests")


@pytest.mark.parametrize("kit", KITS)
def test_the_core_does_not_notice_that_one_is_gone(kit: str, tmp_path: Path) -> None:
    copy = without(tmp_path, needing(kit))
    doctor = subprocess.run([copy / ".venv/bin/seatrial", "doctor"], capture_output=True, text=True)
    assert kit not in doctor.stdout.partition("kits:")[2].partition("\n")[0]
    passes(copy, *NOTICING)


@pytest.mark.parametrize("kit", KITS)
def test_a_kits_own_tests_pass_alone(kit: str) -> None:
    if (ROOT / "tests/kits" / kit).is_dir():
        passes(ROOT, f"tests/kits/{kit}")
