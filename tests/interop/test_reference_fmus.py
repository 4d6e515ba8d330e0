"""The Reference FMUs of the Modelica Association, where SEATRIAL_REFERENCE_FMUS names their folder.

Their release (github.com/modelica/Reference-FMUs) has a folder for each version of FMI. The results
that they are compared with are in the FMUs since 0.0.41, or beside them as ``NAME_out.csv``.
"""

from __future__ import annotations

import csv
import io
import math
import os
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from scipy.integrate import solve_ivp

from seatrial.fmi.files.options import INTERFACES, FmuOptions, Interface
from seatrial.fmi.instance import Instance
from seatrial.fmi.loading.load import load_fmu, open_instance

pytestmark = pytest.mark.interop
FOLDER = os.environ.get("SEATRIAL_REFERENCE_FMUS", "")
RESULTS = "extra/org.fmi-standard.fmi-ls-ref/{}_out.csv"
EULER = ("BouncingBall", "Dahlquist", "StateSpace", "VanDerPol")
"""Their results are those of their own co-simulation, by Euler's method."""
NAMES = (*EULER, "Feedthrough", "Resource", "Roberts", "Stair")
FMUS = sorted(p for p in Path(FOLDER).rglob("*.fmu") if p.stem in NAMES) if FOLDER else []

if not FMUS:
    pytest.skip("SEATRIAL_REFERENCE_FMUS names no folder of FMUs", allow_module_level=True)


def results(path: Path) -> list[dict[str, str]]:
    name = RESULTS.format(path.stem)
    with zipfile.ZipFile(path) as archive:
        if name in archive.namelist():
            return list(csv.DictReader(io.StringIO(archive.read(name).decode())))
    return list(csv.DictReader((path.parent / f"{path.stem}_out.csv").open()))


def cell(text: str, like: Any) -> Any:
    if isinstance(like, (bool, bytes)):
        return bytes.fromhex(text) if isinstance(like, bytes) else text in ("true", "1")
    return type(like)(text)


def run(instance: Instance, rows: list[dict[str, str]]) -> list[tuple[float, list[Any], list[Any]]]:
    """Return time, what was expected and what came, at every row."""
    variables = instance.variables
    ports = {
        name: [name] if name in variables else [v.name for v in variables.ports[name]]
        for name in rows[0]
        if name != "time" and (name in variables or name in variables.ports)
    }
    instance.initialise(0.0, float(rows[-1]["time"]) + 10.0)
    instance.begin()
    read = instance.reader([scalar for scalars in ports.values() for scalar in scalars])
    compared, before = [], 0.0
    for row in rows:
        t = float(row["time"])
        if t > before:
            instance.step(before, t - before)
        before, values = t, read()
        texts = [
            text
            for name, scalars in ports.items()
            for text in (row[name].split() if len(scalars) > 1 else [row[name]])
        ]
        expected = [cell(text, value) for text, value in zip(texts, values, strict=True)]
        compared.append((t, expected, values))
    return compared


@cache
def van_der_pol() -> Any:
    def derivatives(_t: float, x: Any) -> list[float]:
        return [x[1], (1 - x[0] ** 2) * x[1] - x[0]]

    tolerances = {"rtol": 1e-11, "atol": 1e-12}
    return solve_ivp(derivatives, (0, 20), [2.0, 0.0], dense_output=True, **tolerances).sol


def exact(name: str, t: float) -> list[float]:
    if name == "Dahlquist":
        return [math.exp(-t)]
    if name == "StateSpace":
        return [u * math.exp(t) for u in (1.0, 2.0, 3.0)]
    if name == "VanDerPol":
        return list(van_der_pol()(t))
    g, v = 9.81, math.sqrt(2 * 9.81)
    if t < v / g:
        return [1 - g / 2 * t * t, -g * t]
    t -= v / g
    while (v := 0.7 * v) >= 0.1:
        if t < 2 * v / g:
            return [v * t - g / 2 * t * t, v - g * t]
        t -= 2 * v / g
    return [0.0, 0.0]


@pytest.mark.parametrize("interface", INTERFACES)
@pytest.mark.parametrize("path", FMUS, ids=lambda path: f"{path.parts[-3]}-{path.stem}")
def test_every_row_is_met(path: Path, interface: Interface) -> None:
    """Co-simulation to the last digit; model exchange to 1e-4 of the exact solution."""
    if interface not in load_fmu(path).interfaces:
        pytest.skip(f"no {interface}")
    fmu = load_fmu(path, FmuOptions(interface))
    instance = open_instance(fmu, path.stem)
    try:
        compared = run(instance, results(path))
        can_end = fmu.version > 1 or interface == "model exchange"
        assert instance.ended_at == (9.0 if path.stem == "Stair" and can_end else None)
        instance.terminate()
    finally:
        instance.free()
    for t, expected, found in compared:
        if interface == "model exchange" and path.stem in EULER:
            assert found == pytest.approx(exact(path.stem, t), rel=1e-4, abs=1e-4), t
        else:
            assert found == expected, t
