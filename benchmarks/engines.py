"""One co-simulation of an SSP package in one engine, in a process of its own.

Run as ``python -m benchmarks.engines '[engine, ssp, steps, step, [outputs]]'``; prints JSON: wall
time of the steps in s, of that in the components' own steps where the engine
separates it, and the final values of the outputs. `compare` runs it.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

Result = tuple[float, float | None, dict[str, float]]
"""Wall time, time in the components' steps, final values."""


def _plain(name: str) -> str:
    """Return a name without the points that a package's reader may replace."""
    return name.replace(".", "_")


def _parted(name: str) -> tuple[str, str]:
    """Return component and variable, which is one of three axes of a hull or a scalar."""
    parts = name.split(".")
    at = -2 if len(parts) > 2 else -1
    return ".".join(parts[:at]), ".".join(parts[at:])


def ours(ssp: Path, steps: int, algorithm: str, watch: list[str]) -> Result:
    from seatrial.cosim.assembly import assemble
    from seatrial.cosim.master import Master
    from seatrial.cosim.ssp.reading import read_ssp

    rig = read_ssp(ssp).rig.changed({"algorithm": algorithm})
    system = assemble(rig)
    master = Master(system)
    master.initialise()
    begun = perf_counter()
    for _ in range(steps):
        master.step()
    wall = perf_counter() - begun
    own = sum(times.total_ns for times in master.step_times.values()) * 1e-9
    names = {_plain(".".join(name)): i for i, name in enumerate(master.names)}
    return wall, own, {name: master.signals[names[_plain(name)]] for name in watch}


def fmpy_lists(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    """A loop written by hand: a list call of FMPy to get and to set per type, FMU and step."""
    from fmpy.fmi2 import FMU2Slave

    from seatrial.cosim.assembly import assemble
    from seatrial.cosim.ssp.reading import read_ssp

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
    own = 0.0
    begun = perf_counter()
    for getter, references, names in gets:
        values.update(zip(names, getter(references), strict=True))
    for k in range(steps):
        for setter, references, names in sets:
            setter(references, [values[name] for name in names])
        for slave in slaves:
            before = perf_counter()
            slave.doStep(k * step, step)
            own += perf_counter() - before
        for getter, references, names in gets:
            values.update(zip(names, getter(references), strict=True))
    wall = perf_counter() - begun
    plain = {_plain(name): value for name, value in values.items()}
    return wall, own, {name: plain[_plain(name)] for name in watch}


def fmpy_ssp(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    """FMPy's own; its set-up cannot be separated here: see `compare`."""
    from fmpy.ssp.simulation import simulate_ssp

    begun = perf_counter()
    result = simulate_ssp(str(ssp), stop_time=(steps - 0.5) * step, step_size=step)
    wall = perf_counter() - begun
    return (
        wall,
        None,
        {name: float(result[name][-1]) for name in watch if name in result.dtype.names},
    )


def libcosim(ssp: Path, steps: int, watch: list[str]) -> Result:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(ssp_path=str(ssp))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    execution.step()  # initialises
    begun = perf_counter()
    for _ in range(steps - 1):
        execution.step()
    wall = (perf_counter() - begun) * steps / (steps - 1)
    values = {}
    for name in watch:
        slave, variable = _parted(name)
        index = execution.slave_index_from_instance_name(slave)
        reference = next(
            v.reference for v in execution.slave_variables(index) if v.name.decode() == variable
        )
        values[name] = observer.last_real_values(index, [reference])[0]
    return wall, None, values


def ecos(ssp: Path, steps: int, step: float, watch: list[str]) -> Result:
    ctypes.CDLL(
        str(Path(sysconfig.get_path("data")) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL
    )
    from ecospy.EcosSimulation import EcosSimulation

    simulation = EcosSimulation(step_size=step, ssp_path=str(ssp))
    simulation.init()
    begun = perf_counter()
    for _ in range(steps):
        simulation.step()
    wall = perf_counter() - begun
    return wall, None, {name: simulation.get_real("::".join(_parted(name))) for name in watch}


def main() -> None:
    engine, ssp, steps, step, watch = json.loads(sys.argv[1])
    path = Path(ssp)
    run: dict[str, Callable[[], Result]] = {
        "seatrial": lambda: ours(path, steps, "plain-jacobi", watch),
        "seatrial, feed-through read again": lambda: ours(path, steps, "jacobi", watch),
        "FMPy, a loop of list calls": lambda: fmpy_lists(path, steps, step, watch),
        "FMPy simulate_ssp": lambda: fmpy_ssp(path, steps, step, watch),
        "libcosimpy": lambda: libcosim(path, steps, watch),
        "ecospy": lambda: ecos(path, steps, step, watch),
    }
    wall, own, values = run[engine]()
    answer: dict[str, Any] = {"wall": wall, "own": own, "values": values}
    sys.stdout.write("\n" + json.dumps(answer) + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu's library may crash in its exit handlers, after all work is done


if __name__ == "__main__":
    main()
