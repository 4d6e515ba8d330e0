"""The whole loop in libcosim against our plain Jacobi."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from seatrial.model.component import seconds
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.files import find_file
from seatrial.system.flattening import load_rig
from seatrial.system.system import Engine, System
from seatrial_kits.native.engine import carry_natively

_KINDS = {float: "real", int: "integer", bool: "boolean", str: "string"}


def plain(name: str, folder: Path) -> Path:
    """Return a copy of a shipped rig that couples as libcosim does."""
    text = find_file("harness/rigs", name).read_text("utf-8")
    path = folder / f"{name}.toml"
    path.write_text(f'algorithm = "plain-jacobi"\n{text}', "utf-8")
    return path


def job(system: System, steps: int) -> dict[str, Any]:
    slaves, watch = [], []
    for part in system.parts.values():
        variables = part.instance.variables
        slave: dict[str, Any] = {"name": part.name, "path": str(part.instance.fmu.path)}
        for kind, word in _KINDS.items():
            slave[word] = {
                variables[name].reference: given.value
                for name, given in part.given.items()
                if variables[name].type is kind
            }
        slaves.append(slave)
        outputs = [v for v in variables.values() if v.causality == "output" and v.type is float]
        watch.append([part.name, [v.reference for v in outputs]])
    connections = []
    for connection in system.connections:
        source = system.parts[connection.source[0]].instance.variables[connection.source[1]]
        target = system.parts[connection.target[0]].instance.variables[connection.target[1]]
        connections.append(
            [
                connection.source[0],
                source.reference,
                connection.target[0],
                target.reference,
                _KINDS[target.type],
            ]
        )
    step = seconds(system.rig.step_ns)
    return {
        "slaves": slaves,
        "connections": connections,
        "step": step,
        "steps": steps,
        "watch": watch,
    }


def ours(system: System, steps: int) -> tuple[list[str], list[list[float]]]:
    master = Master(system)
    master.initialise()
    watched = [  # in the order of the job's "watch"
        (part.name, variable.name)
        for part in system.parts.values()
        for variable in part.instance.variables.values()
        if variable.causality == "output" and variable.type is float
    ]
    places = [master.names.index(name) for name in watched]
    rows = []
    for _ in range(steps):
        master.step()
        rows.append([master.signals[i] for i in places])
    return [".".join(name) for name in watched], rows


@pytest.mark.parametrize(
    ("rig", "engine", "drone", "hull"),
    [
        ("hydrone-open-loop", "fmu", "downwash", "hull"),
        ("landing", "fmu", "drone", "vehicle.hull"),
        ("landing", "native", "drone", "vehicle.hull"),
    ],
)
def test_libcosim_and_our_plain_jacobi_agree(
    rig: str, engine: Engine, drone: str, hull: str, tmp_path: Path
) -> None:
    steps = 1200
    system = assemble(load_rig(str(plain(rig, tmp_path))), engine)
    system.set(f"{drone}.pad", "diagonal-aft", "test")
    system.set(f"{drone}.phase", "takeoff", "test")
    carry_natively(system)
    runner = Path(__file__).with_name("libcosim_run.py")
    done = subprocess.run(
        [sys.executable, str(runner)],
        input=json.dumps(job(system, steps)), capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    theirs = json.loads(done.stdout.splitlines()[-1])
    names, rows = ours(system, steps)
    system.free()
    for column, name in enumerate(names):
        scale = max(1.0, max(abs(row[column]) for row in rows))
        worst = max(abs(a[column] - b[column]) for a, b in zip(rows, theirs, strict=True))
        assert worst <= 1e-9 * scale, name
    roll = names.index(f"{hull}.attitude.phi")
    assert max(abs(row[roll]) for row in rows) > 0.15  # it is the take-off that was compared
