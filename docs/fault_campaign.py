"""The table of the campaign of faults: ``python docs/fault_campaign.py`` makes it anew.

With the folder of a run of that campaign, the table is made of that.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

import numpy as np

from seatrial import load_campaign_result, run_campaign
from seatrial.api.campaigns import CaseResult

PAGE = Path(__file__).resolve().parent / "how-to" / "inject-faults.md"
PLACE = re.compile(
    r"(<!-- made by docs/fault_campaign\.py -->\n).*?(<!-- end of the campaign -->)", re.DOTALL
)
AUTOPILOTS = ("guidance", "sketch", "mavlink")


def cell(case: CaseResult) -> str:
    """Return the largest distance from the station and that in the end."""
    if case.status != "complete":
        return f"**{case.status}**"
    signals = case.result.signals
    away = np.hypot(*(np.array(signals[f"vehicle.hull.position.{axis}"]) for axis in "xy"))
    text = f"{away.max():.1f} m, {away[-1]:.1f} m"
    return text if case.passed else f"**{text}**"


def table(folder: Path) -> str:
    """Return the table of a run of the campaign."""
    cells: dict[str, dict[str, str]] = {}
    for case in load_campaign_result(folder).cases:
        cells.setdefault(case.set["faults"], {})[case.set["choices.autopilot"]] = cell(case)
    head = f"| fault | {' | '.join(AUTOPILOTS)} |\n| --- | --- | --- | --- |\n"
    rows = (
        f"| {fault} | {' | '.join(of[name] for name in AUTOPILOTS)} |\n"
        for fault, of in cells.items()
    )
    return head + "".join(rows)


def main() -> None:
    """Run the campaign, unless there is a folder, and write the table."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(place) / "run"
        if len(sys.argv) == 1:
            run_campaign("hydrone-faults", out=folder)
        made = table(folder)
    text = PAGE.read_text("utf-8")
    PAGE.write_text(PLACE.sub(lambda found: f"{found[1]}\n{made}\n{found[2]}", text), "utf-8")


if __name__ == "__main__":
    main()
