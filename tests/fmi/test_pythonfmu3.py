"""An FMI 3.0 FMU that another tool wrote: pythonfmu3."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.fmi.loading.load import load_fmu

WAVES = """
from math import sin

import numpy as np
from pythonfmu3 import (
    Boolean, CoSimulation, Dimension, Fmi3Causality, Fmi3Slave, Fmi3StepResult, Fmi3Variability, Float64, Int32, String,
)


class Waves(Fmi3Slave, CoSimulation):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time, self.height, self.x, self.flag, self.n = 0.0, 2.0, 0.0, True, 4
        self.label, self.u, self.y = "sea", np.array([1.0, 2.0, 3.0]), np.zeros(3)
        triple = {"dimensions": [Dimension(start="3")]}
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous))
        self.register_variable(Float64("height", causality=Fmi3Causality.parameter, variability=Fmi3Variability.fixed))
        self.register_variable(Float64("x", causality=Fmi3Causality.output))
        self.register_variable(Int32("n", causality=Fmi3Causality.input, variability=Fmi3Variability.discrete))
        self.register_variable(Boolean("flag", causality=Fmi3Causality.output))
        self.register_variable(String("label", causality=Fmi3Causality.parameter))
        self.register_variable(Float64("u", causality=Fmi3Causality.input, setter=self.set_u, **triple))
        self.register_variable(Float64("y", causality=Fmi3Causality.output, **triple))

    def set_u(self, values):
        self.u = np.array(values)

    def do_step(self, t, h):
        self.x = self.height * sin(t + h)
        self.y = self.n * self.u
        self.flag = self.x > 0
        if t > 5:
            raise ValueError("too late")
        return Fmi3StepResult()
"""

# In a process of its own: the FMU leaves its folder on sys.path, and its modules.
HOST = """
import json, sys
from pathlib import Path
from seatrial.errors import SimulationError
from seatrial.fmi.loading.load import load_fmu, open_instance

instance = open_instance(load_fmu(Path(sys.argv[1])), "waves")
instance.set_start({"height": 3.0, "label": "océan", "u[2]": 7.0})
instance.initialise(0.0, 10.0)
instance.begin()
instance.writer(["n"])([5])
instance.step(0.0, 0.5)
values = instance.reader(["x", "flag", "label", "n", "y[1]", "y[2]", "y[3]"])()
try:
    instance.step(6.0, 0.5)
except SimulationError as error:
    print(json.dumps([values, str(error)]))
"""


@pytest.fixture
def waves(write, tmp_path: Path) -> Path:
    write("waves.py", WAVES)
    command = [sys.executable, "-m", "pythonfmu3", "build", "-f", "waves.py"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    return tmp_path / "Waves.fmu"


def test_it_runs_like_any_other(waves: Path) -> None:
    command = [sys.executable, "-c", HOST, str(waves)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    values, error = json.loads(done.stdout)
    assert values == [3.0 * math.sin(0.5), True, "océan", 5, 5.0, 35.0, 15.0]
    assert error.startswith("waves: fmi3DoStep(t = 6.0 s, h = 0.5 s) returned fatal: ")
    assert "too late" in error


def test_its_description(waves: Path) -> None:
    fmu = load_fmu(waves)
    assert [v.start for v in fmu.variables.ports["u"]] == [1.0, 2.0, 3.0]
    assert fmu.variables["n"].integers == (-(2**31), 2**31 - 1)
    assert fmu.feedthrough["y[2]"] == ["n", "u[1]", "u[2]", "u[3]"]  # it says no dependencies
