"""Control of the VideoRay: its surface vessel's parameters, table 8.1, rejection of steps."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from parts import elsewhere, part
from parts.markdown import table
from parts.settings import parameters, variants
from parts.ships import verdicts
from seatrial.model.readable import number
from seatrial.trial.records.run_folder import load_run
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign

part("videoray-surface-parameters")(partial(parameters, "videoray-surface"))
part("videoray-surface-variants")(partial(variants, "videoray-surface"))
for _rig in ("videoray-surface-case", "videoray-hold", "videoray-estimated"):
    part(f"{_rig}-trials")(partial(verdicts, _rig))

_UVR = ("u", "v", "r")
_LAWS = ("flat", "P", "PI")
PUBLISHED = {
    "surge": ("0.01499", "0.1608", "−0.2476"),
    "sway": ("−0.06352", "−0.5247", "−0.1907"),
    "yaw": ("0.03352", "0.4354", "−0.3000"),
}


@cache
def ends(campaign: str) -> list[tuple[list[float], list[float]]]:
    """Velocities and nominal velocities of each case 0.5 s before the disturbance goes."""
    found = []
    with elsewhere() as folder:
        run_campaign(load_campaign(campaign), folder / "out", engine="direct")
        for path in sorted((folder / "out").glob("*/signals.csv")):
            run = load_run(path.parent)
            k = int(np.argmin(np.abs(run.time - 186.5)))
            nu, nominal = (
                [float(run.signals[f"{signal}.{axis}"][k]) for axis in _UVR]
                for signal in ("vessel.nu", "law.nominal")
            )
            found.append((nu, nominal))
    return found


@part("videoray-table81")
def table81() -> str:
    """Table 8.1 of the source beside what its model gives."""
    rows = []
    found = ends("videoray-surface-table81")
    for (name, published), (nu, _nominal) in zip(PUBLISHED.items(), found, strict=True):
        shown = [number(value, 6).replace("-", "−") for value in nu]
        cells = [cell for pair in zip(published, shown, strict=True) for cell in pair]
        rows.append((name, *cells))
    head = [cell for axis in _UVR for cell in (f"{axis} published", f"{axis} found")]
    return table(("error of", *head), rows)


def rejection(campaign: str) -> str:
    """Deviations of (u, v, r) from the trajectory under each disturbance, law by law."""
    sizes = load_campaign(campaign).file.grid["disturbance.step_size"]
    found = ends(campaign)
    per_law = [found[i * len(sizes) : (i + 1) * len(sizes)] for i in range(len(_LAWS))]
    rows = [
        (f"`{size}`", *(_deviation(*law[i]) for law in per_law)) for i, size in enumerate(sizes)
    ]
    return table(("disturbance", *_LAWS), rows)


def _deviation(nu: list[float], nominal: list[float]) -> str:
    off = [a - b for a, b in zip(nu, nominal, strict=True)]
    shown = [number(x, 3).replace("-", "−") if abs(x) >= 5e-6 else "0" for x in off]
    return ", ".join(shown)


for _campaign in ("rejection", "rejection-table75", "rejection-table81"):
    part(f"videoray-{_campaign}")(partial(rejection, f"videoray-surface-{_campaign}"))
