"""Our SSP packages in other people's tools, and in ours, against our plain Jacobi."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.system import System
from seatrial_kits.interchange.export import export_ssp
from seatrial_kits.interchange.ssp.reading import read_ssp

from .ssp_tools import run
from .test_libcosim import ours, plain

STEPS = 1200
TRIAL = """rig = "{}"
stop = "12 s"
set = {{ "drone.pad" = "diagonal-aft", "drone.phase" = "takeoff" }}
"""
ROLL = "vehicle.hull.attitude.phi"

Expected = tuple[list[str], list[list[float]]]
"""Names of outputs, and their values after each step."""


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a take-off from the Hydrone, which keeps its station: rigs in a rig."""
    folder = tmp_path_factory.mktemp("package")
    path = folder / "takeoff.toml"
    path.write_text(TRIAL.format(plain("landing", folder).name), "utf-8")
    return path


@pytest.fixture(scope="module")
def package(trial: Path) -> Path:
    path, notes = export_ssp(str(trial), trial.with_name("flat.ssp"), tool="libcosim")
    assert notes == []  # plain Jacobi is what other tools do
    return path


@pytest.fixture(scope="module")
def nested(trial: Path) -> Path:
    return export_ssp(str(trial), trial.with_name("nested.ssp"))[0]


@pytest.fixture(scope="module")
def expected(trial: Path) -> Expected:
    system = assemble(load_rig(str(trial.with_name("landing.toml"))))
    system.set("drone.pad", "diagonal-aft", "test")
    system.set("drone.phase", "takeoff", "test")
    return stepped(system)


def stepped(system: System) -> Expected:
    try:
        return ours(system, STEPS)
    finally:
        system.free()


def flat(names: list[str]) -> list[str]:
    """Return the names of outputs in a package of one system."""
    return [re.sub(r"^(vehicle|autopilot)\.(\w+)\.", r"\1_\2.", name) for name in names]


def compare(
    names: list[str], ours: list[list[float]], theirs: list[list[float]], tolerance: float
) -> None:
    for column, name in enumerate(names):
        scale = max(1.0, max(abs(row[column]) for row in ours))
        worst = max(abs(a[column] - b[column]) for a, b in zip(ours, theirs, strict=True))
        assert worst <= tolerance * scale, name
    roll = names.index(ROLL)
    assert max(abs(row[roll]) for row in ours) > 0.15  # it is the take-off that was compared


def test_a_package_runs_alike_in_libcosim(package: Path, expected: Expected) -> None:
    names, rows = expected
    compare(names, rows, run("libcosim", package, steps=STEPS, watch=flat(names)), 1e-9)


def test_a_package_runs_alike_in_ecos(package: Path, expected: Expected) -> None:
    # ecos reads an output when it is asked, after the connections have moved: what an input acts on
    # at once is a step ahead of the record. All others must be equal.
    system = assemble(read_ssp(package).rig)
    through = {
        f"{part.name}.{name}"
        for part in system.parts.values()
        for name, inputs in part.instance.feedthrough.items()
        if inputs
    }
    system.free()
    names, rows = expected
    theirs = flat(names)
    kept = [column for column, name in enumerate(theirs) if name not in through]
    assert len(kept) >= 18
    mine = [[row[column] for column in kept] for row in rows]
    watched = [theirs[column] for column in kept]
    found = run("ecos", package, steps=STEPS, watch=watched)
    compare([names[column] for column in kept], mine, found, 1e-9)


def test_a_package_read_back_is_the_rig_to_the_last_bit(
    package: Path, nested: Path, expected: Expected
) -> None:
    names, rows = expected
    for path, called in ((package, flat(names)), (nested, names)):
        rig = read_ssp(path).rig.changed({"algorithm": "plain-jacobi"})
        assert stepped(assemble(rig)) == (called, rows)


def test_fmpy_runs_a_package_nested_as_in_one_system(
    package: Path, nested: Path, expected: Expected
) -> None:
    # FMPy moves values after the step and not before the first: inputs start at 0.
    names, rows = expected
    theirs = run("fmpy", nested, steps=STEPS, watch=names)
    assert theirs == run("fmpy", package, steps=STEPS, watch=flat(names))
    roll = names.index(ROLL)
    worst = max(abs(a[roll] - b[roll]) for a, b in zip(rows, theirs, strict=True))
    assert 0.0 < worst < 1e-3
