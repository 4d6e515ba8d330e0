"""Rigs, trials, vehicles, profiles and campaigns: whatever is in the file."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path

from seatrial.errors import InputError
from seatrial.system.flattening import load_rig
from seatrial.system.parameters import load_vehicle
from seatrial.system.profile.profile import load_profile
from seatrial.trial.files.trial import load_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.identify.studies.planar_experiment import read_experiment

READERS = (load_trial, load_rig, load_profile, load_vehicle, load_campaign, read_experiment)


def one(data: bytes) -> None:
    """Let every reader have the file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x.toml")
        path.write_bytes(data)
        for read in READERS:
            with contextlib.suppress(InputError):
                read(str(path))
