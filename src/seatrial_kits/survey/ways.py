"""The ways in which an FMU is run, three here and FMPy's; each returns outputs at every point."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Any

from seatrial.errors import SimulationError
from seatrial.fmi.instance import Variable
from seatrial.fmi.interfaces.loaded import LoadedFmu
from seatrial.fmi.loading.built import with_library
from seatrial.fmi.loading.load import open_instance
from seatrial.model.component import NS
from seatrial.sim.instants import interval
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from .experiment import Experiment

Rows = dict[str, list[Any]]
"""Values of outputs by name, one for each communication point reached."""
Way = Callable[[LoadedFmu, Experiment], Rows]

_NUMBERS = (float, int, bool)


class NotThisWay(Exception):  # noqa: N818  no error: nothing is wrong with the FMU
    """An FMU cannot be run in this way, and need not."""


def compared(fmu: LoadedFmu) -> list[Variable]:
    """Return the outputs that are compared: numbers and Booleans that other tools know."""
    return [
        variable
        for variable in fmu.variables.values()
        if variable.causality == "output" and variable.type in _NUMBERS and not variable.is_made
    ]


def in_python(fmu: LoadedFmu, experiment: Experiment) -> Rows:
    """Step an instance from Python, each call by itself."""
    names = [variable.name for variable in compared(fmu)]
    instance = open_instance(fmu, "survey")
    try:
        instance.initialise(experiment.start_ns / NS, experiment.stop_ns / NS)
        instance.begin()
        read = instance.reader(names)
        rows = [read()]
        t_ns, h_ns = experiment.start_ns, experiment.step_ns
        while len(rows) <= experiment.steps and instance.ended_at is None:
            instance.step(*interval(t_ns, h_ns, constant=not instance.any_step))
            t_ns += h_ns
            rows.append(read())
        instance.terminate()
    finally:
        instance.free()
    return _by_name(names, rows)


def in_c(fmu: LoadedFmu, experiment: Experiment) -> Rows:
    """Step a rig of the FMU alone by the compiled master."""
    return _in_a_rig(fmu, experiment, isolated=False)


def isolated(fmu: LoadedFmu, experiment: Experiment) -> Rows:
    """Step a rig of the FMU alone, in a process of its own."""
    return _in_a_rig(fmu, experiment, isolated=True)


def by_fmpy(fmu: LoadedFmu, experiment: Experiment) -> Rows:
    """Simulate it by FMPy, in event mode where the FMU has that, with early return."""
    import fmpy

    with tempfile.TemporaryDirectory() as folder:
        unpacked, built = fmu.folder, with_library(fmu).built
        if built is not None:
            unpacked = Path(shutil.copytree(fmu.folder, folder, dirs_exist_ok=True))
            shutil.copytree(built / "binaries", unpacked / "binaries", dirs_exist_ok=True)
        description = fmpy.read_model_description(unpacked, validate=False)
        theirs = {variable.name for variable in description.modelVariables}
        names = [(one, _their_name(one, theirs)) for one in compared(fmu)]
        simulate = partial(
            fmpy.simulate_fmu,
            str(unpacked),
            validate=False,
            model_description=description,
            fmi_type="CoSimulation" if fmu.interface == "co-simulation" else "ModelExchange",
            start_time=experiment.start_ns / NS,
            stop_time=experiment.stop_ns / NS,
            output_interval=experiment.step_ns / NS,
            relative_tolerance=fmu.options.tolerance,
            output=sorted({name for _, name in names}),
            record_events=False,
            early_return_allowed=fmu.version > 2,
        )
        if not getattr(fmu.simulation, "hasEventMode", False):
            result = simulate()
        else:
            try:
                result = simulate(use_event_mode=True)
            except Exception:  # some promise what their code does not have, as seen here too
                result = simulate()
    return _at_points(result, names, experiment)


WAYS: Mapping[str, Way] = {
    "in Python": in_python,
    "in C": in_c,
    "isolated": isolated,
    "FMPy": by_fmpy,
}


def _in_a_rig(fmu: LoadedFmu, experiment: Experiment, *, isolated: bool) -> Rows:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "it.fmu").symlink_to(fmu.path)
        lines = [
            f'step = "{experiment.step_ns} ns"',
            'algorithm = "plain-jacobi"',
            "[components.fmu]",
            'fmu = "it.fmu"',
            f"isolated = {str(isolated).lower()}",
        ]
        if fmu.options.tolerance is not None:
            lines.append(f"tolerance = {fmu.options.tolerance!r}")
        file = Path(folder) / "survey.toml"
        file.write_text("\n".join(lines) + "\n", "utf-8")
        system = assemble(load_rig(str(file)))
    for name in fmu.variables.of_role("seed"):
        del system.parts["fmu"].given[name]  # its own, since nobody else derives one from a rig's
    try:
        master = Master(system, experiment.start_ns, experiment.stop_ns)
        master.initialise()
        if not isolated and not master.is_compiled:
            raise NotThisWay
        names = [variable.name for variable in compared(fmu)]
        places = [master.names.index(("fmu", name)) for name in names]
        rows = [[master.signals[place] for place in places]]
        while len(rows) <= experiment.steps and not master.ended():
            master.step()
            rows.append([master.signals[place] for place in places])
        master.terminate()
    finally:
        system.free()
    return _by_name(names, rows)


def _by_name(names: Sequence[str], rows: Sequence[Sequence[Any]]) -> Rows:
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def _their_name(variable: Variable, theirs: set[str]) -> str:
    """Return FMPy's name: an array of FMI 3.0 is one variable there."""
    if variable.name in theirs:
        return variable.name
    return variable.array or variable.name.rpartition("[")[0]


def _at_points(result: Any, names: Sequence[tuple[Variable, str]], experiment: Experiment) -> Rows:
    """Return the last values that FMPy has of each communication point.

    FMPy does not negate what in FMI 1.0 is a negated alias.
    """
    h = experiment.step_ns / NS
    last: dict[int, int] = {}
    for row, t in enumerate(result["time"]):
        point = round((t - experiment.start_ns / NS) / h)
        if abs(t - experiment.start_ns / NS - point * h) < 1e-6 * h:
            last[point] = row
    points = list(takewhile(last.__contains__, range(experiment.steps + 1)))
    if not points:
        raise SimulationError("FMPy has not recorded the start")
    rows = [last[point] for point in points]
    found: Rows = {}
    for variable, name in names:
        column = result[name][rows].reshape(len(rows), -1)
        sign = -1 if variable.negated else 1  # FMPy leaves that out
        found[variable.name] = (
            sign * column[:, variable.element if column.shape[1] > 1 else 0]
        ).tolist()
    return found
