"""A step of single components in C and in Python: ``python -m benchmarks.components``.

Steps of 10 ms with all real inputs set before and all real outputs read after, in a host of C and
of the object in process, in turn; the least of some rounds. ``--write`` puts the table into
docs/kits/native/native.md.
"""

from __future__ import annotations

import argparse
import platform
import subprocess
import tempfile
from pathlib import Path
from time import process_time

import fmpy

from seatrial.fmi.components.index import component_class
from seatrial.fmi.components.source import find_source
from seatrial.model.component import Component
from seatrial_kits.native.cached import native_fmu

from .pages import write_measured

COMPONENTS = (
    *("marine-craft", "thruster", "gnss", "compass", "imu", "propulsion", "downwash"),
    *("station-keeping", "guidance", "dynamic-positioning", "thruster-matrix-allocation"),
)
STEPS, PYTHON_STEPS, ROUNDS = 100_000, 2_000, 3
HOST = Path(__file__).with_name("native") / "steps.c"


def references(component: Component, kind: str) -> list[int]:
    """Return the value references of all real inputs or outputs."""
    return [s.reference for s in component.scalars if s.port.kind == kind and s.port.type is float]


class Subject:
    """A component with both carriers."""

    def __init__(self, name: str, folder: Path, host: Path) -> None:
        self.cls = component_class(name)
        source = find_source(name, Path())
        assert not isinstance(source, Path)
        values = {n: v for n, v in self.cls.exercised.items() if n in self.cls.structural}
        component = self.cls()
        for port, value in values.items():
            component.set(port, value)
        self.values = {s.name: component.values[s.reference] for s in component.scalars}
        given = {n: v for n, v in self.values.items() if n.partition(".")[0] in values}
        path = native_fmu(source, given)
        unzipped = Path(fmpy.extract(str(path), str(folder / name)))
        (library,) = (unzipped / "binaries").rglob("*.so")
        guid = fmpy.read_model_description(str(path)).guid
        inputs, outputs = (references(component, kind) for kind in ("input", "output"))
        numbers = [STEPS, len(inputs), len(outputs), *inputs, *outputs]
        self.command = [host, library, guid, *map(str, numbers)]

    def native(self) -> float:
        """Return the time of a step in C, us."""
        done = subprocess.run(self.command, capture_output=True, text=True, check=True)
        return float(done.stdout)

    def python(self) -> float:
        """Return the time of a step in Python, us."""
        component = self.cls()
        for s in component.scalars:
            if s.port.kind == "parameter":
                component.set(s.name, self.values[s.name])
        component.setup(0.0)
        component.initialise()
        component.begin()
        inputs, outputs = (references(component, kind) for kind in ("input", "output"))
        values, begun = component.read(inputs, float), 0.0
        for k in range(-PYTHON_STEPS // 10, PYTHON_STEPS):
            if k == 0:
                begun = process_time()
            values = [value + 1e-9 for value in values]
            component.write(inputs, values, float)
            component.advance(component.now, 0.01)
            component.read(outputs, float)
        return (process_time() - begun) / PYTHON_STEPS * 1e6


def main() -> None:
    """Measure, print, and write the page if that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="write docs/kits/native/native.md")
    write = parser.parse_args().write
    rows = [
        "| CPU time of a step of 10 ms, µs | native | Python, in process | ratio |",
        "| --- " * 4 + "|",
    ]
    with tempfile.TemporaryDirectory(prefix="seatrial-") as name:
        folder, host = Path(name), Path(name, "steps")
        headers = Path(fmpy.__file__).parent / "c-code"
        subprocess.run(["cc", "-O2", f"-I{headers}", HOST, "-o", host, "-ldl"], check=True)
        for component in COMPONENTS:
            subject = Subject(component, folder, host)
            pairs = [(subject.native(), subject.python()) for _ in range(ROUNDS)]
            native, python = (min(column) for column in zip(*pairs, strict=True))
            rows.append(f"| `{component}` | {native:.2f} | {python:.1f} | {python / native:.0f} |")
            print(rows[-1], flush=True)
    measured = (
        "`python -m benchmarks.components`: all real inputs set before, outputs read after, the "
        "rest as it starts (station keeping not enabled); the least of "
        f"{ROUNDS} rounds of {STEPS:,} and {PYTHON_STEPS:,} steps, on {platform.machine()} with "
        f"Python {platform.python_version()}."
    )
    if write:
        write_measured("kits/native/native.md", "\n".join([*rows, "", measured]))


if __name__ == "__main__":
    main()
