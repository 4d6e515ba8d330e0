"""Tables of the Hydrone's page: a drone on its deck, and what else the response depends on."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from parts import elsewhere, part
from parts.hydrone import PHASE_NAMES, SPOOL_UP
from parts.markdown import fixed, table
from seatrial.trial.records.run_folder import Run, load_run
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign

_BOW = 0.638
_LIFT_OFF = 10.5


def _runs(name: str) -> Iterator[tuple[dict[str, Any], Run]]:
    """Yield what each case of a campaign sets, and its run."""
    with elsewhere() as folder:
        run_campaign(load_campaign(name), folder / "out", engine="direct")
        for case in json.loads((folder / "out/campaign.json").read_text())["cases"]:
            yield {**case["set"], "trial": case["trial"]}, load_run(folder / "out" / case["folder"])


@part("hydrone-deck-limits")
def hydrone_deck_limits() -> str:
    """The campaign hydrone-deck-pads."""
    rows = []
    for chosen, run in _runs("hydrone-deck-pads"):
        phase, signals, t = chosen["choices.phase"], run.signals, run.time
        # A take-off begins with the craft at rest unloaded, which sinks under the drone at first.
        standing = (t >= 2.0) & (t < (SPOOL_UP if phase == "takeoff" else math.inf))
        flown = t < (_LIFT_OFF if phase == "takeoff" else math.inf)
        late = t >= (SPOOL_UP if phase == "takeoff" else 0.0)
        pitch, roll = (signals[f"hull.attitude.{a}"] for a in ("theta", "phi"))
        rows.append(
            (
                PHASE_NAMES[phase],
                chosen["choices.pad"],
                fixed(100 * signals["deck.lateral_share"][standing].max(), 1),
                fixed(np.degrees(np.abs(roll[flown]).max()), 2),
                fixed(signals["deck.sliding"][standing].max(), 2),
                fixed(signals["deck.tipping"][standing].max(), 2),
                fixed(100 * _BOW * np.sin(max(0.0, -pitch[late].min())), 1),
                fixed(100 * signals["deck.bow_immersion"][late].max(), 1),
            )
        )
    head = (
        *(
            "phase",
            "landing point",
            "force along the deck, % of weight",
            "roll with it on deck, deg",
        ),
        *("of friction 0.6", "of tipping", "bow by pitch, cm", "bow with heave, cm"),
    )
    return table(head, rows)


@part("hydrone-sensitivity-more")
def hydrone_sensitivity_more() -> str:
    """The campaign hydrone-sensitivity-more."""
    rows = []
    for chosen, run in _runs("hydrone-sensitivity-more"):
        phase = chosen["trial"].rpartition("-")[2]
        varied = [
            f"{key.removesuffix(' times')} × {value}"
            for key, value in chosen.items()
            if key.endswith(" times")
        ]
        late = run.time >= (SPOOL_UP if phase == "takeoff" else 0.0)
        angles = [np.degrees(run.signals[f"hull.attitude.{a}"][late]) for a in ("phi", "theta")]
        z = run.signals["hull.position.z"][late]
        rows.append(
            (
                PHASE_NAMES[phase],
                varied[0] if varied else "unchanged",
                *(fixed(angle[np.argmax(np.abs(angle))], 2) for angle in angles),
                fixed(z[np.argmax(np.abs(z))], 4),
            )
        )
    head = ("phase", "changed", "largest roll, deg", "largest pitch, deg", "largest heave, m")
    return table(head, rows)
