"""Run folders made from the reference trajectories of the Hydrone."""

from __future__ import annotations

import base64
import csv
import json
import re
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from seatrial.trial.criteria.criteria import parse

REFERENCE = Path(__file__).parents[1] / "reference"
PADS = {
    "nominal": (0.0, 0.0, -0.2),
    "longitudinal": (0.319, 0.0, -0.2),
    "transversal": (0.0, 0.25, -0.2),
    "diagonal_fore": (0.319, 0.25, -0.2),
}
COLUMNS = {
    "hull.position.x": ("x", "m"),
    "hull.position.y": ("y", "m"),
    "hull.position.z": ("z", "m"),
    "hull.attitude.phi": ("phi", "rad"),
    "hull.attitude.theta": ("theta", "rad"),
    "hull.attitude.psi": ("psi", "rad"),
    "hull.velocity.u": ("u", "m/s"),
    "hull.velocity.v": ("v", "m/s"),
    "hull.velocity.w": ("w", "m/s"),
    "hull.rates.p": ("p", "rad/s"),
    "hull.rates.q": ("q", "rad/s"),
    "hull.rates.r": ("r", "rad/s"),
    "downwash.force.z": ("Fz", "N"),
}
WriteRun = Callable[..., Path]


def reference(phase: str, scenario: str, variant: str = "source") -> dict[str, Any]:
    """Return a reference trajectory: ``time``, and the signals in `COLUMNS`."""
    data = np.genfromtxt(
        REFERENCE / f"hydrone_{variant}_{phase}_{scenario}.csv", delimiter=",", names=True
    )
    return {"time": data["t"]} | {name: data[column] for name, (column, _) in COLUMNS.items()}


def criteria(phase: str) -> dict[str, str]:
    """Return the limits of the source, table 7, by name."""
    start = {"landing": "4 s", "takeoff": "10.5 s"}[phase]
    return {
        "roll stays below 10 degrees": "abs(hull.attitude.phi) < 10 deg",
        "pitch stays below 5 degrees": "abs(hull.attitude.theta) < 5 deg",
        "heave settles": f"hull.position.z settles within 5 s after {start}",
    }


def _parameter(value: Any, unit: str, **where: str) -> dict[str, Any]:
    origin = {"from": "start value of the FMU", "source": "", "mark": ""}
    return {"value": value, "unit": unit, **origin, **where}


def _manifest(phase: str, scenario: str, signals: Mapping[str, str]) -> dict[str, Any]:
    stated = {"from": "vehicles/hydrone/vehicle.toml [marine-craft]", "mark": "stated"}
    pad = dict(zip("xyz", PADS[scenario], strict=True))
    return {
        "format": 1,
        "seatrial": "0.1.0",
        "versions": {"python": "3.11.2", "numpy": "2.4.6"},
        "trial": {
            "name": f"hydrone-{phase}",
            "title": f"Hydrone, {phase}, {scenario} pad",
            "file": f"hydrone-{phase}.toml",
            "sha256": "0" * 64,
        },
        "rig": {"name": "hydrone", "file": "hydrone.toml", "sha256": "1" * 64},
        "engine": "direct",
        "variant": "source",
        "seed": 1,
        "start": 0.0,
        "stop": 20.0,
        "step": 0.01,
        "algorithm": "jacobi",
        "components": {
            "hull": {
                "fmu": "marine-craft",
                "sha256": "2" * 64,
                "step": 0.01,
                "parameters": {
                    "mass": _parameter(21.987, "kg", source="[Timm2026], table 5", **stated),
                    "added_mass.x": _parameter(1.10, "kg", source="[Timm2026], eq. 39", **stated),
                    "added_mass.y": _parameter(17.59, "kg", source="[Timm2026], eq. 39", **stated),
                    "added_mass.z": _parameter(17.59, "kg", source="[Timm2026], eq. 39", **stated),
                    "restoring": _parameter("surface-linear", "1"),
                    "start_attitude.psi": _parameter(0.5235987755982988, "rad"),
                },
            },
            "downwash": {
                "fmu": "downwash",
                "sha256": "3" * 64,
                "step": 0.01,
                "parameters": {
                    "phase": _parameter(phase, "1"),
                    "mass": _parameter(
                        10.0, "kg", source="[Timm2026], text under table 8", **stated
                    ),
                    **{f"pad.{axis}": _parameter(value, "m") for axis, value in pad.items()},
                },
                "views": {"landing-point": {"place": "pad", "phase": "phase"}},
                "outline": {"length": 1.276, "beam": 1.0},
            },
        },
        "connections": [
            ["hull.attitude", "downwash.attitude"],
            ["downwash.force", "hull.force_2"],
            ["downwash.moment", "hull.moment_2"],
        ],
        "signals": {
            name: {"unit": unit, "description": f"signal {name}"} for name, unit in signals.items()
        },
        "criteria": [{"name": name, "check": check} for name, check in criteria(phase).items()],
        "events": [],
        "status": "complete",
        "error": None,
    }


def write_run_folder(
    folder: Path,
    phase: str = "landing",
    scenario: str = "transversal",
    extra: Mapping[str, tuple[str, Any]] | None = None,
    changes: Mapping[str, Any] | None = None,
) -> Path:
    """Write a run folder from a reference trajectory.

    ``extra`` adds signals, (unit, column) by name; ``changes`` replaces keys of the manifest.
    """
    columns = reference(phase, scenario)
    time = columns.pop("time")
    units = {name: unit for name, (_, unit) in COLUMNS.items()}
    for name, (unit, column) in (extra or {}).items():
        columns[name], units[name] = column, unit
    folder.mkdir(parents=True)
    with (folder / "signals.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time", *columns])
        for row in zip(time, *columns.values(), strict=True):
            writer.writerow([v if isinstance(v, str) else repr(float(v)) for v in row])
    manifest = _manifest(phase, scenario, units) | dict(changes or {})
    verdicts = [
        {"name": name, "check": check, **_plain(parse(check).evaluate(time, columns, units))}
        for name, check in criteria(phase).items()
    ]
    timing = {"wall_s": {"assemble": 0.2, "run": 0.05}, "steps": 2000, "real_time_factor": 400.0}
    for name, content in (("manifest", manifest), ("verdicts", verdicts), ("timing", timing)):
        (folder / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    return folder


def _plain(verdict: Any) -> dict[str, Any]:
    return vars(verdict) | {"limits": [list(limit) for limit in verdict.limits]}


@pytest.fixture
def write_run(tmp_path: Path) -> WriteRun:
    """Return `write_run_folder` for a folder named below a temporary one."""

    def write(name: str = "run", **options: Any) -> Path:
        return write_run_folder(tmp_path / name, **options)

    return write


def unpacked(text: str) -> bytes:
    """Return what a page carries packed, by Python's own decoder."""
    return zlib.decompress(base64.b85decode(text.strip().replace(",", "<")))


def figures_of(page: str) -> list[dict[str, Any]]:
    """Return the figures in a part of a page."""
    carried = re.findall(r'text/x-figure">(.*?)</script>', page, re.DOTALL)
    return [json.loads(unpacked(text)) for text in carried]


def figure_below(page: str, heading: str) -> Any:
    """Return the first figure below a heading of a page."""
    return figures_of(page[page.index(heading) :])[0]
