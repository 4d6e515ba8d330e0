"""Without the libraries of the extras every command says which one to install, or does its work.

Their import is refused here, as it is where they are not installed.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from seatrial.cli.commands import examples
from seatrial.kits import LIBRARIES, kits

pytestmark = pytest.mark.interop
ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS = {
    extra: [Requirement(text).name for text in lines]
    for extra, lines in PROJECT["optional-dependencies"].items()
    if extra not in ("all", "dev", "docs", "fuzz", "mutate")
}
KNOWN = {name: text for kit in kits().found for name, text in kit.libraries.items()} | LIBRARIES
REFUSED = sorted({*KNOWN, "plotly", "matplotlib", "pandas"} - {"google"})
OF_THEIR_USERS = {"dask", "distributed", "h5netcdf", "h5py", "xarray"}
"""Libraries for which whoever imports them says it."""
SITE = f"""
import sys
from importlib.machinery import PathFinder

class Refusing(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        refused = name.partition(".")[0] in {REFUSED!r}
        return None if refused else PathFinder.find_spec(name, path, target)

sys.meta_path[sys.meta_path.index(PathFinder)] = Refusing
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a run, and a module that makes Python refuse libraries."""
    folder = tmp_path_factory.mktemp("base")
    (folder / "sitecustomize.py").write_text(SITE)
    return folder


def alone(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "200"}
    command = [sys.executable, "-m", "seatrial", *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_every_library_of_an_extra_is_known_with_it() -> None:
    modules: dict[str, set[str]] = {}
    for module, distributions in packages_distributions().items():
        for distribution in distributions:
            modules.setdefault(canonicalize_name(distribution), set()).add(module)
    for extra, distributions in EXTRAS.items():
        for distribution in set(distributions) - OF_THEIR_USERS:
            said = {KNOWN.get(module) for module in modules[canonicalize_name(distribution)]} - {
                None
            }
            assert said, f"{distribution} of {extra}"
            assert {str(text).partition("[")[2].rstrip("]") for text in said} <= set(EXTRAS)


def test_a_trial_runs_and_its_report_is_written(folder: Path) -> None:
    done = alone(folder, "run", "hydrone-landing", "--engine", "direct", "-o", "runs/landing")
    assert done.returncode == 0, done.stderr
    page = (folder / "runs/landing/report.html").read_text("utf-8")
    assert "pygraphviz is not installed: pip install &quot;seatrial[diagrams]&quot;" in page
    assert "seatrialViewer" not in page
    shutil.copytree(folder / "runs/landing", folder / "runs/quick")


COMMANDS = {
    "export runs/landing --mcap": 'mcap is not installed: pip install "seatrial[logs]"',
    "export runs/landing --parquet": 'pip install "seatrial[parquet]"',
    "play runs/landing": 'viser is not installed: pip install "seatrial[live]"',
    "live sil --vehicle otter": 'viser is not installed: pip install "seatrial[live]"',
    "run gloria-can --engine direct": 'cantools is not installed: pip install "seatrial[can]"',
    "run mariner-chart-plotter --engine direct": 'pip install "seatrial[nmea]"',
    "run gloria-nmea0183 --engine direct": 'pynmeagps is not installed: pip install "seatrial[nmea]"',
    "describe sil --diagram x.svg": 'pygraphviz is not installed: pip install "seatrial[diagrams]"',
    "campaign hydrone-landing-map --ask limits --engine direct": "pip install",
    "compare runs/landing runs/quick": "",
    "report runs/landing": "",
    "design mariner": "",
    "doctor": "",
    "fmu describe imu": "",
    "list otter": "",
    "profile describe gloria": 'pip install "seatrial[can]"',
    "ssp export hydrone-landing -o landing.ssp": "",
    "osp export hydrone-landing -o landing-osp": "",
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_says_the_line_or_does_its_work(folder: Path, command: str) -> None:
    if not (folder / "runs/quick").exists():
        test_a_trial_runs_and_its_report_is_written(folder)
    done = alone(folder, *shlex.split(command))
    said = COMMANDS[command]
    assert "Traceback" not in done.stderr
    assert done.returncode == (2 if said else 0), done.stderr
    assert said in done.stderr


@pytest.mark.sampled(3)
@pytest.mark.parametrize("command", sorted({each.partition(" ")[0] for each in examples()}))
def test_every_help_needs_none(folder: Path, command: str) -> None:
    done = alone(folder, command, "--help")
    assert done.returncode == 0, done.stderr
    assert "Example: seatrial" in done.stdout
