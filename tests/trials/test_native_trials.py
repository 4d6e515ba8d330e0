"""Shipped trials that run wholly in native code, components and master: none may fall out."""

from __future__ import annotations

import pytest

from seatrial.shipped import available
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.preparation import prepare
from seatrial_kits.native.engine import in_python

NATIVE = [
    "bluerov2-attitude",
    "bluerov2-course-box",
    "bluerov2-drive",
    "collision",
    "dive",
    "drone-landing-deck",
    "glide",
    "gloria-backstepping-0",
    "gloria-backstepping-135",
    "gloria-backstepping-30",
    "gloria-backstepping-90",
    "gloria-capsize",
    "gloria-fast-servo",
    "gloria-fixed-0",
    "gloria-fixed-135",
    "gloria-fixed-30",
    "gloria-fixed-90",
    "gloria-gusts-55",
    "gloria-gusts-60",
    "gloria-pid-0",
    "gloria-pid-135",
    "gloria-pid-30",
    "gloria-pid-90",
    "gloria-steady",
    "hydrone-battery",
    "hydrone-course-current",
    "hydrone-course-fault",
    "hydrone-course-modes",
    "hydrone-course-square",
    "hydrone-deck-landing",
    "hydrone-deck-landing-slip",
    "hydrone-deck-landing-waves",
    "hydrone-deck-limits",
    "hydrone-drone-landing",
    "hydrone-drone-landing-fault",
    "hydrone-drone-landing-waves",
    "hydrone-landing",
    "hydrone-landing-waves",
    "hydrone-open-landing",
    "hydrone-open-landing-waves",
    "hydrone-open-takeoff",
    "hydrone-takeoff",
    "mariner-course-change",
    "mariner-disturbance",
    "mariner-disturbance-pd",
    "mariner-seaway",
    "mariner-source-initial",
    "mariner-source-negative",
    "mariner-source-proportional",
    "mariner-source-step",
    "mariner-step-20",
    "mariner-step-5",
    "mariner-turning-circle",
    "otter-course-square",
    "otter-full-ahead",
    "otter-straight",
    "supply-ship-station",
    "thruster-ship-combined",
    "thruster-ship-load",
    "thruster-ship-load-fivefold",
    "thruster-ship-load-lag",
    "thruster-ship-move",
    "thruster-ship-open-loop",
    "under-way",
    "videoray-course-box",
    "videoray-course-pilot",
    "videoray-drive-ahead",
    "videoray-drive-holds",
    "videoray-drive-surface",
    "videoray-excite-heave",
    "videoray-excite-planar",
    "videoray-excite-surge",
    "videoray-excite-yaw",
    "videoray-hold-pull",
    "videoray-open-ascent",
    "videoray-open-heave",
    "videoray-open-surge",
    "videoray-open-yaw",
    "videoray-surface-case-1",
    "videoray-surface-case-1-flat",
    "videoray-surface-case-2",
    "videoray-surface-case-2-flat",
    "videoray-surface-case-3",
    "videoray-surface-case-3-flat",
    "videoray-surface-nominal",
    "videoray-surface-step",
    "videoray-surface-step-flat",
    "videoray-surface-step-p",
    "videoray-surface-table81-surge",
    "videoray-surface-table81-sway",
    "videoray-surface-table81-yaw",
    "wam-v-course",
]
"""Found by running all shipped trials with ``--engine native``."""


@pytest.mark.interop
@pytest.mark.parametrize("name", NATIVE)
def test_every_component_has_c(name: str) -> None:
    assert name in available("harness/trials")
    prepared = prepare(load_trial(name), "direct", Hooks())
    try:
        assert in_python(prepared.system) == {}
    finally:
        prepared.system.free()
