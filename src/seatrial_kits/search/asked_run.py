"""One run of a question again, from the folder that has the answer."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.records.run_schema import CAMPAIGN, checked_json
from seatrial_kits.campaigns.asked import asked_of
from seatrial_kits.campaigns.campaign import INDEX, Campaign
from seatrial_kits.campaigns.cases import Case
from seatrial_kits.campaigns.distributions import Law, number_and_unit
from seatrial_kits.campaigns.identity import identity_of, refuse_changed
from seatrial_kits.campaigns.questions import Questions
from seatrial_kits.campaigns.results.finding import read_answer
from seatrial_kits.campaigns.sweep import index_of, refuse_other
from seatrial_kits.campaigns.table import RESULTS, read_rows

from .space import space_of


def asked_run(campaign: Campaign, folder: Path, number: int) -> Case:
    """Return a run of the question whose answer is in ``folder``, by its number from 1.

    It sets what the table's row says. Raises InputError for a folder of another campaign, or of
    this one before its files changed, and a number that the table does not have.
    """
    question = read_answer(folder).question
    engine = checked_json(folder / INDEX, CAMPAIGN).get("engine")
    settings = (campaign.file.ask or Questions()).model_dump()
    identity, index = identity_of(campaign), folder / INDEX
    refuse_other(index, index_of(campaign, identity, engine, 0, [question, settings]))
    refuse_changed(index, identity)
    cases = asked_of(campaign, question)
    space = space_of(campaign, question, f"{campaign.read_from.path}: ask")
    rows = read_rows(folder / RESULTS)
    count = 0
    for count, row in enumerate(rows, 1):
        if count == number:
            laws = zip(space.keys, space.laws, strict=True)
            cases.rows[number - 1] = {k: _setting(law, row[k]) for k, law in laws if k in row}
            return cases[number - 1]
    raise InputError(f"--case: a number from 1 to {count} is needed, found {number}")


def _setting(law: Law, value: Any) -> Any:
    """Return what a run has set, of which the table has ``value``."""
    if not law.levels:
        [setting] = law.settings(np.array([value]))
        return setting
    return next(level for level in law.levels if value in _shown(level))


def _shown(level: Any) -> list[Any]:
    """Return a level as the table may have it: as it is, its number, or as JSON."""
    number = number_and_unit(level)[0] if isinstance(level, str) else level
    return [level, number, json.dumps(level)]
