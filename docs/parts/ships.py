"""Criteria of trials and what was found; the two ships' own tables."""

from __future__ import annotations

import json
from functools import partial

from parts import elsewhere, part
from parts.markdown import table
from seatrial.model.readable import number
from seatrial.shipped import available
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.design.heading import design_heading
from seatrial_kits.design.heading_page import rows as design_rows
from seatrial_kits.design.heading_page import stability


def verdicts(rig: str) -> str:
    """Every criterion of the trials whose names are, or begin, so, and what was found.

    Trials in real time are for whoever connects.
    """
    rows = []
    names = (name for name in available("harness/trials") if f"{name}-".startswith(f"{rig}-"))
    for name in sorted(names, key=lambda name: f"{name}.toml"):  # as files are listed
        trial = load_trial(name)
        if trial.file.real_time:
            continue
        with elsewhere() as folder:
            run = load_run(run_trial(trial, folder / "out", engine="direct").folder)
        for verdict in run.verdicts:
            found = verdict["detail"].partition("; ")[0].replace("-", "−")
            holds = "yes" if verdict["passed"] else "**no**"
            rows.append((f"`{name}`", verdict["name"], holds, found))
    return table(("trial", "criterion", "holds", "found"), rows)


for _rig in (
    *("gloria-fixed", "gloria-pid", "gloria-backstepping"),
    *("mariner", "thruster-ship", "videoray-open", "videoray-drive", "videoray-tethered"),
    *("otter", "bluerov2", "dive", "glide", "supply-ship", "wam-v"),
):
    part(f"{_rig}-trials")(partial(verdicts, _rig))


@part("mariner-gains")
def mariner_gains() -> str:
    """Gains of the source's ship for a damping ratio of 0.7071, and limits of stability."""
    design = design_heading("mariner", "source", (0.0, -1.3427, 1.25379))
    stable = {number(one.derivative_time, 6): stability(one) for one in design.loci}
    return table(
        ("T_d, L/U", "K", "poles, U/L", "least damping ratio", "stable for"),
        [
            (
                row.derivative_time.replace("-", "−"),
                row.K,
                row.poles.replace("-", "−"),
                row.damping,
                stable[row.derivative_time],
            )
            for row in design_rows(design)
        ],
    )


@part("thruster-ship-cases")
def thruster_ship_cases() -> str:
    """The six published cases after 10 s, nonlinear and linear."""
    lines = []
    with elsewhere() as folder:
        run_campaign(load_campaign("thruster-ship-cases"), folder / "out", engine="direct")
        for case in json.loads((folder / "out/campaign.json").read_text())["cases"]:
            end = {k: v[-1] for k, v in load_run(folder / "out" / case["folder"]).signals.items()}
            ends = [
                [end[f"{model}.{s}"] for s in ("position.x", "position.y", "attitude.psi")]
                for model in ("nonlinear", "linear")
            ]
            shown = [number(value, 6).replace("-", "−") for value in (*ends[0], *ends[1])]
            lines.append((next(iter(case["set"].values())), *shown))
    axes = ("x, m", "y, m", "psi, rad")
    head = [f"{model} {axis}" for model in ("nonlinear", "linear") for axis in axes]
    return table(("case", *head), lines)


@part("thruster-ship-sweep")
def thruster_ship_sweep() -> str:
    """The shares of the control effort that the source sets up, nonlinear less linear at 10 s."""
    lines = []
    with elsewhere() as folder:
        run_campaign(load_campaign("thruster-ship-sweep"), folder / "out", engine="direct")
        for case in json.loads((folder / "out/campaign.json").read_text())["cases"]:
            signals = load_run(folder / "out" / case["folder"]).signals
            apart = [
                signals[f"nonlinear.{s}"][-1] - signals[f"linear.{s}"][-1]
                for s in ("position.x", "position.y", "attitude.psi")
            ]
            (demand,) = case["set"].values()
            shares = [100 * f / most for f, most in zip(demand, (2.5e5, 2.5e5, 1e7), strict=True)]
            shown = [number(1e3 * value, 3).replace("-", "−") for value in apart]
            lines.append((*(f"{share:g}" if share else "" for share in shares), *shown))
    head = ("F_x, %", "F_y, %", "M_z, %", "x apart, mm", "y apart, mm", "psi apart, mrad")
    return table(head, lines)
