"""One co-simulation of an SSP package in one engine, in a process of its own.

Run as ``python -m benchmarks.engines '[engine, ssp, steps, step, [outputs]]'``; prints JSON:
processor time of the steps in s, peak memory in MB, and the final values of the outputs. `compare`
runs it.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Any

from .pages import peak_memory

Result = tuple[float, dict[str, float]]
"""Processor time of the steps, final values."""


def _plain(name: str) -> str:
    """Return a name without the points that a package's reader may replace."""
    return name.replace(".", "_")


def _parted(name: str) -> tuple[str, str]:
    """Return component and variable, which is one of three axes of a hull or a scalar."""
    parts = name.split(".")
    at = -2 if len(parts) > 2 else -1
    return ".".join(parts[:at]), ".".join(parts[at:])


def ours(ssp: Path, steps: int, algorithm: str, watch: list[str], *, python: bool) -> Result:
    from seatrial.sim import master as module
    from seatrial.system.assembling.assembly import assemble
    from seatrial_kits.interchange.ssp.reading import read_ssp

    if python:
        module.is_compiled = lambda _system: False
    rig = read_ssp(ssp).rig.changed({"algorithm": algorithm})
    system = assemble(rig)
    master = module.Master(system)
    master.initialise()
    begun, left = process_time(), steps
    while left:
        left -= master.advance(left)
    taken = process_time() - begun
    names = {_plain(".".join(name)): i for i, name in enumerate(master.names)}
    return taken, {name: master.signals[names[_plain(name)]] for name in watch}


def fmpy_arrays(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    """A loop written by hand for real numbers: FMI's functions, in arrays allocated once."""
    from seatrial.system.assembling.assembly import assemble
    from seatrial_kits.interchange.ssp.reading import read_ssp

    system = assemble(read_ssp(ssp).rig)
    places: dict[tuple[str, str], int] = {}
    gets: list[Any] = []
    sets: list[Any] = []
    slaves: list[Any] = []
    for name, part in system.parts.items():
        instance = part.instance
        instance.set_start({n: given.value for n, given in part.given.items()})
        instance.initialise(0.0, float("inf"))
        instance.begin()
        slave = instance._slave
        slaves.append((slave.fmi2DoStep, slave.component))
        outputs = [v for v in instance.variables.values() if v.causality == "output"]
        first, count = len(places), len(outputs)
        places |= {(name, v.name): first + i for i, v in enumerate(outputs)}
        references = (ctypes.c_uint * count)(*(v.reference for v in outputs))
        values = (ctypes.c_double * count)()
        gets.append((slave.fmi2GetReal, slave.component, references, count, values, first))
    for name, part in system.parts.items():
        fed = [w for w in system.connections if w.target[0] == name]
        inputs = [part.instance.variables[w.target[1]].reference for w in fed]
        references, count = (ctypes.c_uint * len(fed))(*inputs), len(fed)
        sources = [places[w.source] for w in fed]
        slave, values = part.instance._slave, (ctypes.c_double * count)()
        sets.append((slave.fmi2SetReal, slave.component, references, count, values, sources))
    signals = [0.0] * len(places)

    def read() -> None:
        for get, component, references, count, values, first in gets:
            get(component, references, count, values)
            signals[first : first + count] = values[:]

    begun = process_time()
    read()
    for k in range(steps):
        for put, component, references, count, values, sources in sets:
            values[:] = [signals[place] for place in sources]
            put(component, references, count, values)
        for do_step, component in slaves:
            do_step(component, k * step, step, 1)
        read()
    taken = process_time() - begun
    named = {_plain(".".join(name)): signals[place] for name, place in places.items()}
    return taken, {name: named[_plain(name)] for name in watch}


def container(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    """The container FMU that FMUContainer has made of the package, in blocks of 100 steps."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    path = str(ssp.with_suffix(".fmu"))
    description = read_model_description(path, validate=False)
    slave = FMU2Slave(
        guid=description.guid, unzipDirectory=extract(path), instanceName="container",
        modelIdentifier=description.coSimulation.modelIdentifier,
    )  # fmt: skip
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    begun = process_time()
    for k in range(0, steps, 100):
        slave.doStep(k * step, 100 * step)
    taken = process_time() - begun
    references = {v.name: v.valueReference for v in description.modelVariables}
    return taken, {name: slave.getReal([references[name]])[0] for name in watch}


def fmpy_lists(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    """A loop written by hand: a list call of FMPy to get and to set per type, FMU and step."""
    from fmpy.fmi2 import FMU2Slave

    from seatrial.system.assembling.assembly import assemble
    from seatrial_kits.interchange.ssp.reading import read_ssp

    system = assemble(read_ssp(ssp).rig)
    gets: list[tuple[Any, list[int], list[str]]] = []
    sets: list[tuple[Any, list[int], list[str]]] = []
    slaves = []
    for name, part in system.parts.items():
        fmu, variables = part.instance.fmu, part.instance.variables
        slave = FMU2Slave(
            guid=fmu.description.guid, unzipDirectory=str(fmu.folder), instanceName=name,
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
        )  # fmt: skip
        slaves.append(slave)
        slave.instantiate()
        getters = {
            float: slave.getReal,
            int: slave.getInteger,
            bool: slave.getBoolean,
            str: slave.getString,
        }
        setters = {
            float: slave.setReal,
            int: slave.setInteger,
            bool: slave.setBoolean,
            str: slave.setString,
        }
        for variable, given in part.given.items():
            setters[variables[variable].type]([variables[variable].reference], [given.value])
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        for kind in getters:
            outputs = [v for v in variables.values() if v.causality == "output" and v.type is kind]
            if outputs:
                names = [f"{name}.{v.name}" for v in outputs]
                gets.append((getters[kind], [v.reference for v in outputs], names))
            connections = [w for w in system.connections if w.target[0] == name]
            connections = [w for w in connections if variables[w.target[1]].type is kind]
            if connections:
                inputs = [variables[w.target[1]].reference for w in connections]
                sets.append((setters[kind], inputs, [".".join(w.source) for w in connections]))
    values: dict[str, Any] = {}
    begun = process_time()
    for getter, references, names in gets:
        values.update(zip(names, getter(references), strict=True))
    for k in range(steps):
        for setter, references, names in sets:
            setter(references, [values[name] for name in names])
        for slave in slaves:
            slave.doStep(k * step, step)
        for getter, references, names in gets:
            values.update(zip(names, getter(references), strict=True))
    taken = process_time() - begun
    plain = {_plain(name): value for name, value in values.items()}
    return taken, {name: plain[_plain(name)] for name in watch}


def fmpy_ssp(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    """FMPy's own; its set-up cannot be separated here: see `compare`."""
    from fmpy.ssp.simulation import simulate_ssp

    begun = process_time()
    result = simulate_ssp(str(ssp), stop_time=(steps - 0.5) * step, step_size=step)
    taken = process_time() - begun
    return taken, {name: float(result[name][-1]) for name in watch if name in result.dtype.names}


def libcosim(ssp: Path, steps: int, watch: list[str]) -> Result:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(ssp_path=str(ssp))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    execution.step()  # initialises
    begun = process_time()
    for _ in range(steps - 1):
        execution.step()
    taken = (process_time() - begun) * steps / (steps - 1)
    values = {}
    for name in watch:
        slave, variable = _parted(name)
        index = execution.slave_index_from_instance_name(slave)
        reference = next(
            v.reference for v in execution.slave_variables(index) if v.name.decode() == variable
        )
        values[name] = observer.last_real_values(index, [reference])[0]
    return taken, values


def ecos(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    ctypes.CDLL(
        str(Path(sysconfig.get_path("data")) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL
    )
    from ecospy.EcosSimulation import EcosSimulation

    simulation = EcosSimulation(step_size=step, ssp_path=str(ssp))
    simulation.init()
    begun = process_time()
    for _ in range(steps):
        simulation.step()
    taken = process_time() - begun
    return taken, {name: simulation.get_real("::".join(_parted(name))) for name in watch}


def main() -> None:
    engine, ssp, steps, step, watch = json.loads(sys.argv[1])
    path = Path(ssp)
    run: dict[str, Callable[[], Result]] = {
        "seatrial": lambda: ours(path, steps, "plain-jacobi", watch, python=False),
        "seatrial, feed-through read again": lambda: ours(
            path, steps, "jacobi", watch, python=False
        ),
        "seatrial, master in Python": lambda: ours(path, steps, "plain-jacobi", watch, python=True),
        "FMUContainer": lambda: container(path, steps, step, watch),
        "FMPy, a loop with arrays": lambda: fmpy_arrays(path, steps, step, watch),
        "FMPy, a loop of list calls": lambda: fmpy_lists(path, steps, step, watch),
        "FMPy simulate_ssp": lambda: fmpy_ssp(path, steps, step, watch),
        "libcosimpy": lambda: libcosim(path, steps, watch),
        "ecospy": lambda: ecos(path, steps, step, watch),
    }
    taken, values = run[engine]()
    memory = peak_memory()
    answer: dict[str, Any] = {"taken": taken, "memory": memory, "values": values}
    sys.stdout.write("\n" + json.dumps(answer) + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu's library may crash in its exit handlers, after all work is done


if __name__ == "__main__":
    main()
