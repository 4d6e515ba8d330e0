"""Files of ``seatrial new ros2-package``: the tutorial's node, and a package that colcon takes."""

import ast
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from tests.command import seatrial

ROOT = Path(__file__).parents[3]


def test_a_package_is_written_whole(tmp_path):
    done = seatrial("new", "ros2-package", "my_boat", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    package = tmp_path / "my_boat"
    page = (ROOT / "docs/kits/ros2/ros2-controller.md").read_text()
    assert (package / "my_boat/helm.py").read_text() == re.search(
        r"```python\n(.*?)```", page, re.S
    )[1]
    assert ElementTree.parse(package / "package.xml").findtext("name") == "my_boat"
    assert (package / "resource/my_boat").is_file()
    for file in package.rglob("*.py"):
        ast.parse(file.read_text())
    assert "@NAME@" not in "".join(f.read_text() for f in package.rglob("*") if f.is_file())
    again = seatrial("new", "ros2-package", "my_boat", cwd=tmp_path)
    assert again.returncode == 2


@pytest.mark.parametrize("name", ["my-boat", "My_boat", "2boats", "my__boat"])
def test_names_that_ros_refuses(name, tmp_path):
    done = seatrial("new", "ros2-package", name, cwd=tmp_path)
    assert done.returncode == 2
    assert name in done.stderr
    assert not list(tmp_path.iterdir())
