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

FOLDER = Path(__file__).resolve().parents[1] / "vehicles/sea-trials"
PUBLISHED: dict[str, Any] = tomllib.loads((FOLDER / "measured.toml").read_text("utf-8"))


def _part(name: str) -> str:
    """Return the table of a vehicle, and what is said of figures that are far off."""
    found = json.loads((FOLDER / "measured.json").read_text("utf-8"))[name]
    figures = PUBLISHED[name]["figures"]
    rows = [_row(each, found[each["figure"]]) for each in figures]
    notes = [f"- {each['figure']}: {each['note']}\n" for each in figures if "note" in each]
    head = ("figure", "real", "this model", "factor", "use", "source")
    return "\n".join([table(head, rows), "".join(notes)]) if notes else table(head, rows)


def _row(figure: dict[str, Any], model: float) -> tuple[str, ...]:
    real, unit = split_quantity(figure["real"]) or (float("nan"), "1")
    shown, factor = quantity_text(model, unit, 3), f"{model / real:.2f}"
    return figure["figure"], figure["real"], shown, factor, figure["use"], figure["source"]


for _name in PUBLISHED:
    part(f"measured-{_name}")(partial(_part, _name))
