"""Trials that stay wholly in C: what makes one of them slow again is noticed here."""

from __future__ import annotations

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.preparation import prepare
from seatrial_kits.native.engine import in_python

WHOLLY_NATIVE = [
    "bluerov2-course-box",
    "hydrone-course-square",
    "hydrone-deck-landing-waves",
    "hydrone-landing",
    "hydrone-landing-waves",
    "hydrone-open-landing-waves",
    "mariner-course-change",
    "mariner-seaway",
    "mariner-turning-circle",
    "otter-course-square",
    "otter-full-ahead",
    "videoray-course-box",
]
"""Landings, waves, courses and squares: docs/kits/native/native.md has all."""


@pytest.mark.slow
@pytest.mark.parametrize("name", WHOLLY_NATIVE)
def test_it_has_nothing_in_python(name: str) -> None:
    system = prepare(load_trial(name), "direct", Hooks()).system
    try:
        assert in_python(system) == {}
    finally:
        system.discard()
