"""Global generators: a run is the same whatever was drawn before it, and leaves them alone."""

import random

import numpy as np
import pytest

import seatrial
from tests.command import seatrial as command

COMPONENT = """
import random
import numpy as np
from seatrial.model.component import Component, Output


class Drawing(Component):
    y = Output("1", "of Python's generator")
    z = Output("1", "of NumPy's")

    def step(self, t, h):
        self.y, self.z = random.random(), float(np.random.rand())
"""


def written(folder):
    (folder / "drawing.py").write_text(COMPONENT, "utf-8")
    rig = 'step = "100 ms"\n[components]\nc = { fmu = "drawing.py:Drawing" }\n'
    (folder / "rig.toml").write_text(rig, "utf-8")
    (folder / "t.toml").write_text('rig = "rig.toml"\nstop = "1 s"\n', "utf-8")
    return folder / "t.toml"


@pytest.mark.slow
def test_runs_are_alike_and_the_caller_s_generators_go_on(tmp_path):
    trial = written(tmp_path)
    random.seed(1)
    np.random.seed(2)
    states = random.getstate(), np.random.get_state()[1].tolist()
    first = seatrial.run_trial(trial, out=tmp_path / "a")
    assert (random.getstate(), np.random.get_state()[1].tolist()) == states
    random.random()
    np.random.rand()
    again = seatrial.run_trial(trial, out=tmp_path / "b")
    other = seatrial.run_trial(trial, out=tmp_path / "c", set={"seed": 5})
    y = [run.signals["c.y"][1:] for run in (first, again, other)]
    assert len(set(y[0])) == 10
    assert list(y[0]) == list(y[1]) != list(y[2])
    built = command("run", str(trial), "--engine", "fmu", "--out", "d", cwd=tmp_path)
    assert built.returncode == 0, built.stderr
    same = [(tmp_path / name / "signals.csv").read_bytes() for name in ("a", "b", "d")]
    assert same[0] == same[1] == same[2]
