"""Tables of the real vehicles beside the models, of the figures that docs/measured.py has kept."""

from __future__ import annotations

import json
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

from parts import part
from parts.markdown import table
from seatrial.model.readable import quantity_text
from seatrial.model.units import split_quantity
from seatrial.system.parameters import load_vehicle

FOLDER = Path(__file__).resolve().parents[1] / "vehicles/sea-trials"
PUBLISHED: dict[str, Any] = tomllib.loads((FOLDER / "measured.toml").read_text("utf-8"))


def _found() -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = json.loads((FOLDER / "measured.json").read_text("utf-8"))
    return found


@part("measured")
def vehicles() -> str:
    """How many figures each vehicle meets, and by how much."""
    rows, found = [], _found()
    for name, vehicle in PUBLISHED.items():
        close = [each for each in vehicle["figures"] if "note" not in each]
        factors = [_factor(each, found[name][each["figure"]]) for each in close]
        fitted = sum(each["use"] == "fitted" for each in close)
        far = len(vehicle["figures"]) - len(close)
        span = f"{min(factors):.2f} to {max(factors):.2f}"
        variant = load_vehicle(name).file.default or ""
        rows.append(
            (f"`{name}`", f"`{variant}`", str(fitted), str(len(close) - fitted), span, str(far))
        )
    head = ("vehicle", "default variant", "fitted", "checked", "their factors", "explained")
    return table(head, rows)


def _part(name: str) -> str:
    """Return the table of a vehicle, and what is said of figures that are far off."""
    found, figures = _found()[name], PUBLISHED[name]["figures"]
    rows = [_row(each, found[each["figure"]]) for each in figures]
    notes = [f"- {each['figure']}: {each['note']}\n" for each in figures if "note" in each]
    head = ("figure", "real", "this model", "factor", "use", "source")
    return "\n".join([table(head, rows), "".join(notes)]) if notes else table(head, rows)


def _row(figure: dict[str, Any], model: float) -> tuple[str, ...]:
    _, unit = split_quantity(figure["real"]) or (0.0, "1")
    shown, factor = quantity_text(model, unit, 3), f"{_factor(figure, model):.2f}"
    return figure["figure"], figure["real"], shown, factor, figure["use"], figure["source"]


def _factor(figure: dict[str, Any], model: float) -> float:
    """Return the model's figure over that of the real vehicle, in the unit of the latter."""
    real, _ = split_quantity(figure["real"]) or (float("nan"), "1")
    return model / real


for _name in PUBLISHED:
    part(f"measured-{_name}")(partial(_part, _name))
