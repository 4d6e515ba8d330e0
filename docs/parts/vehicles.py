"""Every vehicle under every autopilot that fits it."""

from __future__ import annotations

from parts import elsewhere, part
from parts.markdown import table
from seatrial.trial.running.run import Result
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.cases import Case
from seatrial_kits.campaigns.in_folders import run_campaign


@part("vehicles-campaign")
def vehicles() -> str:
    """The cases of the campaign `vehicles`, and what holds in each."""
    with elsewhere() as folder:
        _, finished = run_campaign(load_campaign("vehicles"), folder / "all", engine="direct")
    return table(
        ("vehicle", "autopilot", "trial", "criteria that hold"),
        [_row(case, result) for case, result in sorted(finished, key=_vehicle)],
    )


def _vehicle(run: tuple[Case, Result]) -> str:
    case, _ = run
    return case.trial.rig.top.choices.get("vehicle", case.trial.name.partition("-")[0])


def _row(case: Case, result: Result) -> tuple[str, ...]:
    choices, rig = case.trial.rig.top.choices, case.trial.rig.read_from.name
    more = [f"`{key} = {value}`" for key, value in case.set.items() if key not in _SHOWN]
    held = sum(verdict.passed for _, _, verdict in result.verdicts)
    return (
        f"`{_vehicle((case, result))}`",
        f"`{choices['autopilot']}`" if "autopilot" in choices else f"the rig `{rig}`",
        ", ".join([f"`{case.trial.name}`", *more]),
        f"{held} of {len(result.verdicts)}",
    )


_SHOWN = ("choices.vehicle", "choices.autopilot")
