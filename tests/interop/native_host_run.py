"""Run FMUs beside each other in a host of other people, in a process of its own; prints JSON.

The host is the argument. Reads {"step": s, "steps": n, "slaves": [{"name", "path", "changes":
[[step, type, variable, value reference, value]], "outputs": [[type, variable, value reference]]}]}
from standard input. Prints the outputs of each slave after every step.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

Job = dict[str, Any]
Rows = dict[str, list[list[float]]]


def libcosim(job: Job) -> Rows:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(round(job["step"] * 1e9))
    index = {
        slave["name"]: execution.add_local_slave(CosimLocalSlave(slave["path"], slave["name"]))
        for slave in job["slaves"]
    }
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert execution.add_observer(observer)
    assert execution.add_manipulator(manipulator)
    words = {"float": "real", "int": "integer", "bool": "boolean", "str": "string"}

    def give(slave: Any, kind: str, _name: str, reference: int, value: Any) -> None:
        set_values = getattr(manipulator, f"slave_{words[kind]}_values")
        assert set_values(index[slave["name"]], [reference], [value])

    def value_of(slave: Any, kind: str, _name: str, reference: int) -> float:
        last_values = getattr(observer, f"last_{words[kind]}_values")
        return float(last_values(index[slave["name"]], [reference])[0])

    return _stepped(job, give, value_of, lambda _k: execution.step())


def ecos(job: Job) -> Rows:
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    for slave in job["slaves"]:
        structure.add_model(slave["name"], slave["path"])
    simulation = EcosSimulation(step_size=job["step"], structure=structure)
    assert simulation.init()
    words = {"float": "real", "int": "integer", "bool": "bool", "str": "string"}

    def give(slave: Any, kind: str, name: str, _reference: int, value: Any) -> None:
        getattr(simulation, f"set_{words[kind]}")(f"{slave['name']}::{name}", value)

    def value_of(slave: Any, kind: str, name: str, _reference: int) -> float:
        return float(getattr(simulation, f"get_{words[kind]}")(f"{slave['name']}::{name}"))

    return _stepped(job, give, value_of, lambda _k: simulation.step())


def fmucontainer(job: Job) -> Rows:
    """Make one FMU of all, each output and changed input one of its own; FMPy runs it."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave
    from fmu_manipulation_toolbox.assembly import Assembly

    folder = Path(job["slaves"][0]["path"]).parent
    inputs, outputs = {}, {}
    for slave in job["slaves"]:
        file = Path(slave["path"]).name
        for _, _, name, _, _ in slave["changes"]:
            inputs[slave["name"], name] = [f"{slave['name']} {name}", file, name]
        for _, name, _ in slave["outputs"]:
            outputs[slave["name"], name] = [file, name, f"{slave['name']} {name}"]
    assembly = {
        "name": "all.fmu",
        "step_size": job["step"],
        "auto_input": False,
        "auto_output": False,
        "auto_link": False,
        "fmu": [Path(slave["path"]).name for slave in job["slaves"]],
        "input": list(inputs.values()),
        "output": list(outputs.values()),
    }
    (folder / "all.json").write_text(json.dumps(assembly), "utf-8")
    Assembly("all.json", fmu_directory=folder).make_fmu()
    description = read_model_description(str(folder / "all.fmu"))
    references = {v.name: v.valueReference for v in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        modelIdentifier=description.coSimulation.modelIdentifier,
        unzipDirectory=extract(str(folder / "all.fmu"), str(folder / "all")),
        instanceName="all",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    words = {"float": "Real", "int": "Integer", "bool": "Boolean", "str": "String"}

    def give(slave: Any, kind: str, name: str, _reference: int, value: Any) -> None:
        getattr(fmu, f"set{words[kind]}")([references[f"{slave['name']} {name}"]], [value])

    def value_of(slave: Any, kind: str, name: str, _reference: int) -> float:
        return float(getattr(fmu, f"get{words[kind]}")([references[f"{slave['name']} {name}"]])[0])

    return _stepped(job, give, value_of, lambda k: fmu.doStep(k * job["step"], job["step"]))


def _stepped(
    job: Job,
    give: Callable[..., None],
    value_of: Callable[..., float],
    step: Callable[[int], object],
) -> Rows:
    rows: Rows = {slave["name"]: [] for slave in job["slaves"]}
    for k in range(job["steps"]):
        for slave, change in _changes(job, k):
            give(slave, *change)
        step(k)
        for slave in job["slaves"]:
            rows[slave["name"]].append([value_of(slave, *each) for each in slave["outputs"]])
    return rows


def _changes(job: Job, k: int) -> Iterator[tuple[Any, list[Any]]]:
    for slave in job["slaves"]:
        for at, *change in slave["changes"]:
            if at == k:
                yield slave, change


if __name__ == "__main__":
    host = {"libcosim": libcosim, "ecos": ecos, "fmucontainer": fmucontainer}[sys.argv[1]]
    result = json.dumps(host(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)
