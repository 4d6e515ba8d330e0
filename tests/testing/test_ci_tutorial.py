"""The tutorial on CI: its repository made from the page, and the action's own script run in it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest
import yaml

from .running import cases

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/tutorials/ci.md").read_text("utf-8")
ACTION = ROOT / ".github/actions/sea-trials"
STEPS = yaml.safe_load((ACTION / "action.yml").read_text("utf-8"))


def repository(folder: Path) -> None:
    """Write the files of the page."""
    found = re.findall(r"^`([^`\n]+)`:\n\n```\w+\n(.*?)^```$", PAGE, re.DOTALL | re.M)
    assert len(found) == 6
    for name, text in found:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")


def inputs(folder: Path) -> dict[str, str]:
    """Return the action's inputs as the page's workflow gives them."""
    workflow = yaml.safe_load((folder / ".github/workflows/sea-trials.yml").read_text("utf-8"))
    (use,) = [
        step for step in workflow["jobs"]["sea-trials"]["steps"] if "sea-trials@" in step["uses"]
    ]
    given = {name: entry["default"] for name, entry in STEPS["inputs"].items()}
    assert use["with"].keys() <= given.keys()
    return given | use["with"]


def run_steps(folder: Path, given: dict[str, str], environment: dict[str, str]) -> list[Any]:
    """Run what the action runs in a shell, as a runner does."""
    done = []
    for step in STEPS["runs"]["steps"]:
        if "run" not in step:
            continue
        own = {
            name: re.sub(r"\$\{\{ (?:inputs\.)?([\w.-]+) \}\}", lambda m: given.get(m[1], ""), text)
            for name, text in step["env"].items()
        }
        shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]
        done.append(
            subprocess.run(
                shell,
                cwd=folder,
                env=environment | own,
                capture_output=True,
                text=True,
                check=False,
            )
        )
    return done


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--quiet"]
    subprocess.run([*build, "--wheel-dir", str(folder), str(ROOT)], check=True)
    return next(folder.glob("*.whl"))


def environment_in(folder: Path, *, downloads: bool) -> dict[str, str]:
    """Make a virtual environment; return the variables of a runner that has it first."""
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    if not downloads:  # requirements are those of this environment
        (packages,) = folder.glob("lib/python*/site-packages")
        (packages / "requirements.pth").write_text(sysconfig.get_path("purelib") + "\n", "utf-8")
    kept = {
        k: v for k, v in os.environ.items() if not k.startswith(("GITHUB_", "PYTEST_", "PYTHON"))
    }
    return kept | {
        "PATH": f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}",
        "GITHUB_ACTION_PATH": str(ACTION),
    }


@pytest.mark.interop
@pytest.mark.parametrize("downloads", [False, pytest.param(True, marks=pytest.mark.long)])
def test_the_repository_of_the_page_passes_and_fails_as_it_should(
    wheel: Path, tmp_path: Path, downloads: bool
) -> None:
    repository(tmp_path / "helm")
    runner = environment_in(tmp_path / "environment", downloads=downloads)
    given = inputs(tmp_path / "helm") | {"package": str(wheel)}

    installed, ran, summary = run_steps(tmp_path / "helm", given, runner)
    assert installed.returncode == 0, installed.stderr
    assert ran.returncode == 0, ran.stdout
    assert summary.returncode == 0, summary.stderr
    assert "5 of 5 tests pass" in summary.stdout
    assert "5 passed" in ran.stdout
    found = cases(tmp_path / "helm/sea-trials/junit.xml")
    assert {"course", "current", "compass", "test_orders_are_answered"} <= set(found)
    assert not any(list(case) and case.find("failure") is not None for case in found.values())
    assert not (tmp_path / "helm/sea-trials/runs").exists()

    sketch = tmp_path / "helm/firmware/helm/helm.ino"
    text = sketch.read_text("utf-8")
    turned = text.replace("ahead + turn", "ahead # turn").replace("ahead - turn", "ahead + turn")
    sketch.write_text(turned.replace("ahead # turn", "ahead - turn"), "utf-8")
    _, ran, summary = run_steps(tmp_path / "helm", given, runner)
    assert ran.returncode == 1
    assert "2 of 5 tests pass" in summary.stdout
    place = "file=trials/course.toml,line=14,title=it turns east and stays there"
    assert f"::error {place}::it turns east and stays there: " in summary.stdout
    found = cases(tmp_path / "helm/sea-trials/junit.xml")
    failed = {name for name, case in found.items() if case.find("failure") is not None}
    assert failed == {"course", "current", "test_an_order_turns_the_boat"}
    said = found["course"].find("failure").text or ""
    assert "it turns east and stays there" in said
    assert "vehicle.hull.attitude.psi" in said  # the plot is of what was recorded
    assert said.count("|") >= 9
    kept = sorted((tmp_path / "helm/sea-trials/runs").iterdir())
    assert len(kept) == 2
    assert all((folder / "report.html").is_file() for folder in kept)


def test_the_table_of_the_page_is_that_of_the_action() -> None:
    rows = re.findall(r"^\| `([\w-]+)` \| ([^|]*) \|", PAGE[PAGE.index("| input |") :], re.M)
    assert [name for name, _ in rows] == list(STEPS["inputs"])
    for name, shown in rows:
        default = STEPS["inputs"][name]["default"]
        assert shown.strip("`") == (
            default
            or {"package": "the action's revision", "base": "the pull request's base"}.get(
                name, "empty"
            )
        )
