"""Terminals in libcosim: connected as groups of variables, by the files beside the FMUs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from seatrial.cli.fmu import fmu_app
from seatrial.fmi.loading.load import load_fmu
from tests.fmi.boats import BARGE

TUG = '''
"""A user's tug."""
from seatrial.model.component import Component, Output
from seatrial.model.terminals import terminal


class Tug(Component):
    """Pushes."""

    force = Output("N", "force", axes="xyz")
    moment = Output("N.m", "moment", axes="xyz")
    lift = Output("N", "lift")
    terminals = {"wrench": terminal("force", "moment", "lift", rule="plug")}

    def outputs(self, t):
        self.force, self.moment, self.lift = (1.0, 2.0, 3.0), (40.0, 50.0, 60.0), 700.0
'''

SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
    <BaseStepSize>0.1</BaseStepSize>
    <Algorithm>fixedStep</Algorithm>
    <Simulators>
        <Simulator name="barge" source="Barge.fmu"/>
        <Simulator name="one" source="Tug.fmu"/>
        <Simulator name="two" source="Tug.fmu"/>
    </Simulators>
    <Connections>
        <VariableGroupConnection>
            <VariableGroup simulator="one" name="wrench"/>
            <VariableGroup simulator="barge" name="wrench"/>
        </VariableGroupConnection>
        <VariableGroupConnection>
            <VariableGroup simulator="two" name="{group}"/>
            <VariableGroup simulator="barge" name="{group_of_barge}"/>
        </VariableGroupConnection>
    </Connections>
</OspSystemStructure>
"""


@pytest.mark.interop
@pytest.mark.parametrize(
    ("group", "expected"),
    [("wrench", [2.0, 4.0, 6.0, 1480.0]), ("wrench.force", [2.0, 4.0, 6.0, 740.0])],
)
def test_libcosim_connects_terms(group: str, expected: list[float], write, tmp_path: Path) -> None:
    components = [f"{write('barge.py', BARGE)}:Barge", f"{write('tug.py', TUG)}:Tug"]
    built = CliRunner().invoke(fmu_app, ["build", "--osp", "--out", str(tmp_path), *components])
    assert built.exit_code == 0, built.output
    text = SYSTEM.format(group=group, group_of_barge=group.replace("wrench", "wrench_2"))
    file = write("OspSystemStructure.xml", text)
    variables = load_fmu(tmp_path / "Barge.fmu").variables
    names = ("position.x", "position.y", "position.z", "depth.a")
    references = [variables[name].reference for name in names]
    job = {"file": str(file), "watch": [["barge", "real", references]], "steps": 3}
    run = subprocess.run(
        [sys.executable, Path(__file__).with_name("osp_libcosim_run.py")],
        input=json.dumps(job),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout.splitlines()[-1])[-1] == expected
