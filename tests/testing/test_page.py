"""The page on pytest: its tests, word for word."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from .running import cases, pytest_in

PAGE = Path(__file__).parents[2] / "docs/how-to/test-with-pytest.md"
SKETCH = Path(__file__).parent / "sketches/rudder"


@pytest.mark.interop
def test_the_tests_of_the_page_pass(tmp_path: Path) -> None:
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.DOTALL | re.M)
    assert len(blocks) == 4
    for number, block in enumerate(blocks):
        (tmp_path / f"test_{number}.py").write_text(block)
    shutil.copytree(SKETCH, tmp_path / "rudder")
    done = pytest_in(tmp_path, "--junitxml", "junit.xml", "-n", "2")
    assert done.returncode == 0, done.stdout
    names = set(cases(tmp_path / "junit.xml"))
    assert "test_a_course[under-way-otter-guidance-seed1]" in names
    assert len(names) == 1 + 4 + 3
    assert not (tmp_path / "runs").exists()
