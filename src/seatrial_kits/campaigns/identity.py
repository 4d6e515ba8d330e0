"""Identity of a campaign, and what has changed since a folder of it was left."""

from __future__ import annotations

from pathlib import Path

from seatrial.errors import InputError
from seatrial.trial.records.identity import IDENTITY, Changes, Identity, hashes
from seatrial.trial.records.program import program
from seatrial.trial.records.run_schema import CAMPAIGN, checked_json

from .campaign import Campaign
from .resuming import Note
from .shipment import files_of


def identity_of(campaign: Campaign) -> Identity:
    """Return the identity of a campaign as its files are now. Raises InputError."""
    base = campaign.read_from.path.resolve().parent
    return Identity(
        program(),
        {trial.name: hashes(files_of(campaign, trial), base) for trial in campaign.trials},
    )


def refuse_changed(index: Path, identity: Identity) -> None:
    """Raise InputError, which names them, for changes since a campaign's index was written."""
    if changes := identity.changed(checked_json(index, CAMPAIGN).get(IDENTITY) or {}):
        raise InputError(f"{index}: changed since: {changes.text()}: no run would be the same")


def changes_since(index: Path, identity: Identity, note: Note, *, rerun_changed: bool) -> Changes:
    """Return what has changed since a campaign's index was written; note it if there is any.

    Raises InputError for changes unless the cases that they touch are to run again.
    """
    changes = identity.changed(checked_json(index, CAMPAIGN).get(IDENTITY) or {})
    if not changes:
        return changes
    if not rerun_changed:
        raise InputError(
            f"{index}: changed since: {changes.text()}; --rerun-changed runs again what these "
            "touch and keeps the rest; or name another folder without --resume"
        )
    touched = "all cases" if changes.program else f"the cases of {', '.join(changes.files)}"
    note(f"changed since: {changes.text()}: {touched} run again")
    return changes
