"""Sea trials of vehicles for their pages: ``python docs/sea_trials.py otter`` runs them.

The folder of a campaign that has run may follow the name. The figures go to
``docs/vehicles/sea-trials/otter.json``, from which docs/tables.py makes the table of the page.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from seatrial.api.campaigns import run_campaign
from seatrial_kits.sea_trials.page import DATA, campaign_page

FOLDER = Path(__file__).resolve().parent / "vehicles/sea-trials"
DIGITS = 4


def kept(trials: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return what the tables are made of: figures to four digits, and what went wrong."""
    rows = []
    for trial in trials:
        figures = {
            name: [float(f"{figure['value']:.{DIGITS}g}"), figure["unit"]]
            for name, figure in trial.get("figures", {}).items()
        }
        row = {"trial": trial["trial"], "side": trial["side"], "length": trial["length"]}
        rows.append({**row, "figures": figures, "error": trial["error"]})
    return rows


def main(vehicle: str, folder: str | None = None) -> None:
    """Keep the figures of a campaign, which is run if no folder has it."""
    with tempfile.TemporaryDirectory() as temporary:
        done = Path(folder or temporary) / ("" if folder else "trials")
        if folder is None:
            run_campaign("sea-trials", set={"choices.vehicle": vehicle}, out=done, engine="native")
        campaign_page(done)
        trials = json.loads((done / DATA).read_text("utf-8"))
    rows = ",\n".join(f" {json.dumps(row)}" for row in kept(trials))
    (FOLDER / f"{vehicle}.json").write_text(f"[\n{rows}\n]\n", "utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
