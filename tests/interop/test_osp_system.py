"""System structures and scenarios in libcosim, and here: the same values after every step."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from seatrial import run_trial
from seatrial.fmi.loading.load import load_fmu
from seatrial_kits.interchange.export import export_osp
from seatrial_kits.interchange.osp.reading import read_osp
from tests.fmi.models import build_model_fmu
from tests.kits.interchange.osp_files import write_osp

from .test_libcosim import plain

pytestmark = pytest.mark.interop
KINDS = {float: "real", int: "integer", bool: "boolean", str: "string"}
STEPS = 30

SCENARIO = {
    "description": "everything a scenario can do",
    "defaults": {"model": "slave uno", "action": "override"},
    "events": [
        {"time": 0.5, "variable": "x", "value": 3.5},
        {"time": 0.95, "variable": "x", "action": "bias", "value": -0.75},
        {"time": 1.4, "variable": "x", "action": "reset"},
        {"time": 0.3, "variable": "gain", "value": 5},
        {"time": 0.3, "model": "two", "variable": "u", "action": "bias", "value": 0.3},
        {"time": 1.0, "model": "two", "variable": "u", "value": 11.0},
        {"time": 1.6, "model": "two", "variable": "u", "action": "reset"},
        {"time": 0.4, "model": "two", "variable": "i", "action": "bias", "value": 4},
        {"time": 0.7, "variable": "i", "action": "bias", "value": 4},
        {"time": 1.1, "variable": "i", "action": "reset"},
        {"time": 0.2, "variable": "b", "value": False},
        {"time": 0.8, "variable": "c", "action": "bias", "value": True},
        {"time": 1.2, "variable": "s", "value": "man overboard"},
        {"time": 1.25, "variable": "j", "value": 40},
        {"time": 1.3, "model": "slow", "variable": "u", "action": "bias", "value": -2.0},
        {"time": 1.7, "model": "slow", "variable": "y", "action": "bias", "value": 0.125},
        {"time": 0.0, "model": "three", "variable": "x", "action": "bias", "value": 1.0},
        {"time": 0, "model": "three", "variable": "speed", "value": 9.5},
    ],
}


SLAVES = ("slave uno", "two", "three", "slow", "last")


def run(job: dict[str, Any]) -> list[list[Any]]:
    """Return the rows of a job of ``osp_libcosim_run.py``."""
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("osp_libcosim_run.py")],
        input=json.dumps(job),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def libcosim(file: Path, scenario: Path | None = None) -> dict[str, tuple[Any, ...]]:
    """Return {signal: values after every step} of libcosim, by the components' names here."""
    package = read_osp(file)
    names = [package.called.get(slave, "slave_uno") for slave in SLAVES]
    slaves = [name if name in package.called else "slave uno" for name in names]
    variables = load_fmu(file.parent / package.rig.components["two"].entry.fmu).variables
    outputs = [  # libcosim has no enumerations, and says that it rolls nothing back
        v
        for v in variables.values()
        if v.causality == "output" and v.name not in ("mode", "never_back")
    ]
    job = {
        "file": str(file),
        "steps": STEPS,
        "watch": [[slave, KINDS[v.type], [v.reference]] for slave in slaves for v in outputs],
        "scenario": str(scenario) if scenario else None,
    }
    rows = run(job)
    signals = [f"{name}.{v.name}" for name in names for v in outputs]
    return dict(zip(signals, zip(*rows, strict=True), strict=True))


def ours(file: Path, folder: Path, scenario: Path | None = None) -> dict[str, tuple[str, ...]]:
    """Return {signal: values after every step} as they are recorded here."""
    settings = {"scenario": str(scenario)} if scenario else {}
    run_trial(str(file), set=settings, engine="fmu", out=folder / "run")
    with (folder / "run" / "signals.csv").open() as lines:
        rows = list(csv.DictReader(lines))[1:]
    return {name: tuple(row[name] for row in rows) for name in rows[0]}


def compare(theirs: dict[str, tuple[Any, ...]], mine: dict[str, tuple[str, ...]]) -> None:
    for name, values in theirs.items():
        if isinstance(values[0], str):
            assert mine[name] == values, name
        else:
            wanted = pytest.approx([float(value) for value in values], rel=1e-12, abs=1e-12)
            assert [float(value) for value in mine[name]] == wanted, name


def test_a_system_structure_runs_as_in_libcosim(tmp_path: Path) -> None:
    file = write_osp(tmp_path)
    theirs = libcosim(file)
    compare(theirs, ours(file, tmp_path))
    assert len({*theirs["slow.p[1]"]}) > 5


@pytest.mark.parametrize("end", [None, 2.2, 1.0])
def test_a_scenario_acts_as_in_libcosim(end: float | None, tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.json"
    content = SCENARIO if end is None else {**SCENARIO, "end": end}
    scenario.write_text(json.dumps(content), "utf-8")
    file = write_osp(tmp_path)
    theirs = libcosim(file, scenario)
    compare(theirs, ours(file, tmp_path, scenario))
    assert 3.5 in theirs["slave_uno.x"]


LOOP = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
    <BaseStepSize>0.04</BaseStepSize>
    <Algorithm>fixedStep</Algorithm>
    <Simulators>
        <Simulator name="DP Controller" source="model1cs.fmu"/>
        <Simulator name="Thrust Allocation" source="model1cs.fmu">
            <InitialValues><InitialValue variable="k"><Real value="0.3"/></InitialValue></InitialValues>
        </Simulator>
        <Simulator name="Ship" source="model1cs.fmu"/>
    </Simulators>
    <Connections>
        <VariableGroupConnection>
            <VariableGroup simulator="Ship" name="position"/>
            <VariableGroup simulator="DP Controller" name="command"/>
        </VariableGroupConnection>
        <VariableGroupConnection>
            <VariableGroup simulator="DP Controller" name="thrust"/>
            <VariableGroup simulator="Thrust Allocation" name="command"/>
        </VariableGroupConnection>
        <VariableGroupConnection>
            <VariableGroup simulator="Thrust Allocation" name="thrust"/>
            <VariableGroup simulator="Ship" name="command"/>
        </VariableGroupConnection>
    </Connections>
</OspSystemStructure>
"""
LOOP_GROUPS = """<?xml version="1.0" encoding="utf-8"?>
<OspModelDescription xmlns="http://opensimulationplatform.com/MSMI/OSPModelDescription" version="0.1">
    <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
    <VariableGroups>
        <Generic name="position">
            <LinearDisplacement name="along"><Variable ref="x" unit="m"/></LinearDisplacement>
        </Generic>
        <Generic name="thrust"><Force name="thrustForce"><Variable ref="y" unit="N"/></Force></Generic>
        <Generic name="command"><Force name="force"><Variable ref="u" unit="N"/></Force></Generic>
    </VariableGroups>
</OspModelDescription>
"""


def test_a_ship_of_fmi_1_slaves_in_a_loop_runs_as_in_libcosim(tmp_path: Path) -> None:
    """Names with spaces, groups inside groups in OSP's older namespace, as in OSP's dp-ship."""
    file = tmp_path / "OspSystemStructure.xml"
    file.write_text(LOOP)
    (tmp_path / "model_OspModelDescription.xml").write_text(LOOP_GROUPS)
    variables = load_fmu(build_model_fmu(1, tmp_path, "co-simulation")).variables
    watched = {
        name: ("real" if variables[name].type is float else "integer", variables[name].reference)
        for name in ("x", "height", "speed", "y", "steps", "relay", "events")
    }
    slaves = {
        "DP Controller": "DP_Controller",
        "Thrust Allocation": "Thrust_Allocation",
        "Ship": "Ship",
    }
    job = {
        "file": str(file),
        "steps": STEPS,
        "watch": [[slave, kind, [vr]] for slave in slaves for kind, vr in watched.values()],
    }
    signals = [f"{name}.{variable}" for name in slaves.values() for variable in watched]
    theirs = dict(zip(signals, zip(*run(job), strict=True), strict=True))
    run_trial(str(tmp_path), set={"stop": "1.2 s"}, engine="fmu", out=tmp_path / "run")
    with (tmp_path / "run" / "signals.csv").open() as lines:
        rows = list(csv.DictReader(lines))[1:]
    compare(theirs, {name: tuple(row[name] for row in rows) for name in signals})
    assert len({*theirs["Ship.x"]}) == STEPS > len({*theirs["Thrust_Allocation.y"]}) > STEPS - 4


def test_what_is_written_runs_in_libcosim_as_what_was_read(tmp_path: Path) -> None:
    file = write_osp(tmp_path)
    folder, _ = export_osp(str(file), tmp_path / "out")
    assert libcosim(folder / "OspSystemStructure.xml") == libcosim(file)


def test_a_rig_written_for_libcosim_runs_there_as_here(tmp_path: Path) -> None:
    trial = tmp_path / "takeoff.toml"
    rig = plain("landing", tmp_path).name
    trial.write_text(f'rig = "{rig}"\nstop = "3 s"\nset = {{ "drone.phase" = "takeoff" }}\n')
    folder, notes = export_osp(str(trial), tmp_path / "out")
    assert notes == []
    table = ours(trial, tmp_path)
    variables = load_fmu(folder / "vehicle_hull.fmu").variables
    outputs = [v for v in variables.values() if v.causality == "output" and v.type is float]
    job = {
        "file": str(folder / "OspSystemStructure.xml"),
        "steps": 300,
        "watch": [["vehicle_hull", "real", [v.reference for v in outputs]]],
    }
    rows = run(job)
    for v, values in zip(outputs, zip(*rows, strict=True), strict=True):
        mine = [float(value) for value in table[f"vehicle.hull.{v.name}"]]
        assert mine == pytest.approx(values, rel=1e-9, abs=1e-9), v.name
