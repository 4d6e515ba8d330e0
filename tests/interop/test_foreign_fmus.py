"""FMUs and systems of others, each here in every way, in FMPy and in libcosim.

They are fetched, and some built, outside the repository: where that cannot be, these tests fail.
Differences, and FMUs that do not run, are those of the table in ``use-other-fmus.md``.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import pytest

from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.rig import duration_ns
from seatrial_kits.interchange.osp.reading import read_osp
from seatrial_kits.interchange.osp.structure import read_structure
from seatrial_kits.survey.surveying import Surveyed, fmus_in, survey

from .foreign import COLLECTIONS, collection

pytestmark = [pytest.mark.interop, pytest.mark.long]
PAGE = Path(__file__).parents[2] / "docs/how-to/use-other-fmus.md"
ROW = re.compile(
    r"^\| `([^`]+\.fmu)`([^|]*)\| (not loaded|fails|differs|runs, no outputs) \| (.+?) \|$", re.M
)
EXPLAINED = {name: (status, why) for name, _, status, why in ROW.findall(PAGE.read_text("utf-8"))}
TIMEOUT_S = 120.0


def explained(one: Surveyed) -> bool:
    """Say if the table has an FMU as it was found, or it has nothing to run on this machine."""
    if one.status == "agrees":
        return True
    for pattern, (status, why) in EXPLAINED.items():
        if fnmatchcase(one.path.name, pattern) and one.status == status:
            by = re.match(r"by (\S+):", why)
            most = float(by[1]) if by else 0.0
            return all(apart.value <= most for apart in one.differing.values())
    if "cannot be loaded on this machine" not in one.unfit:
        return False
    with zipfile.ZipFile(one.path) as archive:
        members = archive.namelist()
    return not any(
        re.match(r"binaries/(linux64|x86_64-linux)/.|sources/.*\.c$", m) for m in members
    )


@pytest.mark.parametrize("name", COLLECTIONS)
def test_fmus_of_others_agree_with_fmpy(name: str) -> None:
    found = list(survey(fmus_in(collection(name)), TIMEOUT_S))
    assert [
        f"{one.status} {one.path} {one.unfit} {one.problems}" for one in found if not explained(one)
    ] == []
    assert sum(one.status == "agrees" for one in found) >= 5


SYSTEMS = {
    "libcosim": (
        "tests/data/msmi/OspSystemStructure.xml",
        "tests/data/msmi/OspSystemStructure_Dahlquist.xml",
        "tests/data/msmi/OspSystemStructure_EndTime.xml",
        "tests/data/msmi/OspSystemStructure_StateInitExample.xml",
        "tests/data/fmi2/quarter_truck/OspSystemStructure.xml",
    ),
    "demo-cases": ("tutorial-fmus/OspSystemStructure.xml", "dp-ship/OspSystemStructure.xml"),
}
LAST_DIGITS = {"dp-ship/OspSystemStructure.xml": 1e-9}
"""Where outputs differ in their last digits: 20-sim's FMUs of FMI 1.0, from the fifth step on."""
STEPS = {"tests/data/fmi2/quarter_truck/OspSystemStructure.xml": 10_000}
KINDS = {float: "real", int: "integer", bool: "boolean"}


@pytest.mark.parametrize(
    ("name", "file"), [(name, file) for name, files in SYSTEMS.items() for file in files]
)
def test_systems_of_others_run_as_in_libcosim(name: str, file: str, tmp_path: Path) -> None:
    """With fixed steps: libcosim's files ask for ecco, which has a test of its own, or for none."""
    given = collection(name) / file
    text = re.sub(r"<Algorithm>.*</Algorithm>", "", given.read_text("utf-8"))
    text = text.replace("</BaseStepSize>", "</BaseStepSize><Algorithm>fixedStep</Algorithm>")
    for source in {*re.findall(r'source="([^"]+)"', text)}:
        text = text.replace(f'source="{source}"', f'source="{(given.parent / source).as_uri()}"')
    structure = tmp_path / "OspSystemStructure.xml"
    structure.write_text(text, "utf-8")
    steps = STEPS.get(file, 500)
    watched, ours = _ours(structure, steps)
    theirs = _libcosim({"file": str(structure), "steps": steps, "watch": watched})
    assert len(theirs) == steps
    for column, (signal, values) in enumerate(ours.items()):
        others = [row[column] for row in theirs]
        if file in LAST_DIGITS:
            assert values == pytest.approx(
                others, rel=0, abs=LAST_DIGITS[file] * max(map(abs, others))
            )
        else:
            assert values == others, signal


def _ours(structure: Path, steps: int) -> tuple[list[Any], dict[str, list[Any]]]:
    """Return what to watch of each simulator, and the values here after each step, by name."""
    package = read_osp(structure)
    system = assemble(package.rig)
    start = 0 if package.start is None else duration_ns(package.start, "start")
    master = Master(system, start)
    master.initialise()
    watched, places = list[Any](), dict[str, int]()
    parts = [part for part in system.parts.values() if not part.is_sum]
    for part, simulator in zip(parts, read_structure(structure).simulators, strict=True):
        outputs = [v for v in part.instance.variables.values() if v.causality == "output"]
        for kind, called in KINDS.items():
            if of_kind := [v for v in outputs if v.type is kind]:
                watched.append([simulator, called, [v.reference for v in of_kind]])
                places |= {
                    f"{part.name}.{v.name}": master.names.index((part.name, v.name))
                    for v in of_kind
                }
    rows: dict[str, list[Any]] = {name: [] for name in places}
    for _ in range(steps):
        master.step()
        for name, place in places.items():
            rows[name].append(master.signals[place])
    master.terminate()
    system.free()
    return watched, rows


def _libcosim(job: dict[str, Any]) -> list[list[Any]]:
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("osp_libcosim_run.py")],
        input=json.dumps(job), capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    rows: list[list[Any]] = json.loads(done.stdout.splitlines()[-1])
    return rows
