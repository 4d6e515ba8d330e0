"""State that cannot be saved: an error at once for who asks, and the run goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import SimulationError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.loading.load import load_fmu, open_instance

from .conftest import Raw, source
from .native import read, started

STUBBORN = '''
"""Components whose state cannot be saved."""
from seatrial.model.component import Component, Output


class Counting(Component):
    """Counts its steps."""

    steps = Output("1", "steps", type=int)

    def start(self, t):
        self.count = 0

    def step(self, t, h):
        self.count += 1

    def outputs(self, t):
        self.steps = self.count


class Socket(Counting):
    """Says that it reaches outside."""

    rolls_back = False


class Lost(Counting):
    """Holds what is no plain data."""

    def start(self, t):
        super().start(t)
        self.handle = object()
'''
MESSAGES = {
    "Socket": "boat reaches outside the simulation: it has no state to save",
    "Lost": r"state attribute boat\.handle is not plain data: object",
}


@pytest.mark.parametrize("name", MESSAGES)
@pytest.mark.parametrize("carrier", ["fmu", "direct"])
def test_the_instance_goes_on(carrier: str, name: str, write, tmp_path: Path) -> None:
    found = source(write("stubborn.py", STUBBORN), name)
    if carrier == "fmu":
        instance = open_instance(load_fmu(build_fmu(found, tmp_path / "x.fmu")), "boat")
    else:
        instance = DirectInstance(found.component_class()("boat"))
    started(instance)
    assert instance.rolls_back == (name == "Lost")
    instance.step(0.0, 0.1)
    for _ in range(2):
        with pytest.raises(SimulationError, match=MESSAGES[name]):
            instance.get_state()
        assert read(instance, "steps") == [1]
    instance.step(0.1, 0.1)
    assert read(instance, "steps") == [2]
    instance.terminate()
    instance.free()


def test_in_other_tools_only_saving_such_a_state_fails(write, tmp_path: Path, capfd) -> None:
    found = source(write("stubborn.py", STUBBORN), "Lost")
    raw = Raw(build_fmu(found, tmp_path / "x.fmu"), tmp_path / "raw")
    slave = raw.start()
    with pytest.raises(Exception, match="fmi2GetFMUstate"):
        slave.getFMUstate()
    assert "is not plain data" in capfd.readouterr().out
    slave.doStep(0.0, 0.1)
    assert slave.getInteger([raw.vr["steps"]]) == [1]
    slave.freeInstance()
