"""FMUs of users' components, and FMPy's own view of an instance."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from seatrial.fmi.building.bundle import bundle
from seatrial.fmi.building.export import cached_fmu
from seatrial.fmi.components.source import ComponentSource, find_source

from . import boats


def source(path: Path, name: str) -> ComponentSource:
    """Return the component ``name`` of a user's file."""
    found = find_source(f"{path.name}:{name}", path.parent)
    assert isinstance(found, ComponentSource)
    return found


def built_once(component: ComponentSource, path: Path) -> Path:
    """Return a copy, at ``path``, of a component's FMU, which is built once a session."""
    code = bundle(component.stem, component.script, component.folder).script
    return Path(shutil.copyfile(cached_fmu(component, code), path))


class Raw:
    """An FMU driven by FMPy's own classes: not our loader."""

    def __init__(self, path: Path, unpacked: Path) -> None:
        self.description = read_model_description(str(path))
        self.folder = extract(str(path), str(unpacked))
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.slave: Any = None

    def instantiate(self, name: str = "it", logging: bool = True) -> Any:
        self.slave = FMU2Slave(
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=self.folder,
            instanceName=name,
        )
        self.slave.instantiate(loggingOn=logging)
        return self.slave

    def start(self, **values: Any) -> Any:
        slave = self.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        for name, value in values.items():
            slave.setReal([self.vr[name]], [value])
        return slave

    def get(self, name: str) -> float:
        return self.slave.getReal([self.vr[name]])[0]


@pytest.fixture
def counter(write) -> ComponentSource:
    return source(write("counter.py", boats.COUNTER), "Counter")


@pytest.fixture
def counter_fmu(counter: ComponentSource, tmp_path: Path) -> Path:
    return built_once(counter, tmp_path / "counter.fmu")


@pytest.fixture
def raw(counter_fmu: Path, tmp_path: Path) -> Iterator[Raw]:
    it = Raw(counter_fmu, tmp_path / "raw")
    yield it
    if it.slave is not None:
        it.slave.freeInstance()
