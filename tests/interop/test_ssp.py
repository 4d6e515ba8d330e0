"""Our SSP packages in other people's tools, and in ours, against our plain Jacobi."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.cosim.assembly import assemble
from seatrial.cosim.flattening import load_rig
from seatrial.cosim.ssp.reading import read_ssp
from seatrial.cosim.system import System
from seatrial.trials.export import export_ssp

from .ssp_tools import run
from .test_libcosim import ours, plain

STEPS = 1200
TRIAL = """rig = "{}"
stop = "12 s"
set = {{ "downwash.pad" = "diagonal-aft", "downwash.phase" = "takeoff" }}
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the closed loop of the Hydrone, with a take-off, as a package."""
    folder = tmp_path_factory.mktemp("package")
    trial = folder / "takeoff.toml"
    trial.write_text(TRIAL.format(plain("hydrone", folder).name), "utf-8")
    path, notes = export_ssp(str(trial), folder / "takeoff.ssp")
    assert notes == []  # plain Jacobi is what other tools do
    return path


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[str], list[list[float]]]:
    system = assemble(load_rig(str(plain("hydrone", tmp_path_factory.mktemp("rig")))))
    system.set("downwash.pad", "diagonal-aft", "test")
    system.set("downwash.phase", "takeoff", "test")
    return stepped(system)


def stepped(system: System) -> tuple[list[str], list[list[float]]]:
    try:
        return ours(system, STEPS)
    finally:
        system.free()


def compare(
    names: list[str], ours: list[list[float]], theirs: list[list[float]], tolerance: float
) -> None:
    for column, name in enumerate(names):
        scale = max(1.0, max(abs(row[column]) for row in ours))
        worst = max(abs(a[column] - b[column]) for a, b in zip(ours, theirs, strict=True))
        assert worst <= tolerance * scale, name
    roll = names.index("hull.attitude.phi")
    assert max(abs(row[roll]) for row in ours) > 0.15  # it is the take-off that was compared


def test_a_package_runs_alike_in_libcosim(
    package: Path, expected: tuple[list[str], list[list[float]]]
) -> None:
    names, rows = expected
    compare(names, rows, run("libcosim", package, steps=STEPS, watch=names), 1e-9)


def test_a_package_runs_alike_in_ecos(
    package: Path, expected: tuple[list[str], list[list[float]]]
) -> None:
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
    kept = [column for column, name in enumerate(names) if name not in through]
    assert len(kept) >= 18
    watched = [names[column] for column in kept]
    mine = [[row[column] for column in kept] for row in rows]
    compare(watched, mine, run("ecos", package, steps=STEPS, watch=watched), 1e-9)


def test_a_package_read_back_is_the_rig_to_the_last_bit(
    package: Path, expected: tuple[list[str], list[list[float]]]
) -> None:
    rig = read_ssp(package).rig.changed({"algorithm": "plain-jacobi"})
    assert stepped(assemble(rig)) == expected


def test_fmpy_runs_a_package(package: Path, expected: tuple[list[str], list[list[float]]]) -> None:
    # FMPy moves values after the step and not before the first: inputs start at 0.
    names, rows = expected
    theirs = run("fmpy", package, steps=STEPS, watch=names)
    roll = names.index("hull.attitude.phi")
    worst = max(abs(a[roll] - b[roll]) for a, b in zip(rows, theirs, strict=True))
    assert 0.0 < worst < 1e-3
