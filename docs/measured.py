"""Figures of the models that were published of the real ones: ``python docs/measured.py otter``.

``docs/vehicles/sea-trials/measured.toml`` says what was published of each vehicle, and how its rig
is run for the same figure. The values go to ``measured.json`` beside it, from which docs/tables.py
makes the tables of the pages.
"""

from __future__ import annotations

import json
import sys
import tomllib
from pathlib import Path
from typing import Any

from seatrial import Simulation
from seatrial.model.readable import from_si
from seatrial.model.units import quantity, split_quantity

FOLDER = Path(__file__).resolve().parent / "vehicles/sea-trials"
PUBLISHED = FOLDER / "measured.toml"
FOUND = FOLDER / "measured.json"
DIGITS = 4


def published() -> dict[str, dict[str, Any]]:
    """Return what is published: by vehicle ``rig``, ``set`` and ``figures``."""
    return tomllib.loads(PUBLISHED.read_text("utf-8"))


def found(vehicle: dict[str, Any], figure: dict[str, Any]) -> float:
    """Return a figure of the model: at ``stop``, the sum of the signals of ``read``.

    It is in the unit of the ``real`` one.
    """
    setting = {**vehicle.get("set", {}), **figure["set"]}
    with Simulation(vehicle["rig"], set=setting, variant=vehicle.get("variant")) as sim:
        sim.run(quantity(figure["stop"], "s"))
        value = sum(weight * float(sim.get(name)) for name, weight in figure["read"].items())
    _, unit = split_quantity(figure["real"]) or (0.0, "1")
    return float(f"{from_si(value, unit):.{DIGITS}g}")


def main(vehicles: list[str]) -> None:
    """Run the figures of the vehicles, or of all, and keep the values."""
    every = published()
    kept = json.loads(FOUND.read_text("utf-8")) if FOUND.exists() else {}
    for name in vehicles or every:
        vehicle = every[name]
        kept[name] = {each["figure"]: found(vehicle, each) for each in vehicle["figures"]}
    FOUND.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
