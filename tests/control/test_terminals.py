"""Terminals of control, joined by member, against what the shipped rigs connect by hand."""

import pytest

from tests.terminals import Terminals

HOLDS = (
    "guidance.wanted speed_hold.wanted; guidance.wanted heading_hold.wanted;"
    "guidance.wanted helm.wanted; speed_hold.held helm.held; heading_hold.held helm.held;"
    "helm.demand allocation.demand; course.orders guidance.orders"
)
SAILING = (
    "course.orders guidance.orders; guidance.wanted heading.wanted; guidance.wanted helm.wanted;"
    "guidance.wanted trimmer.wanted; navigation.estimate heading.estimate;"
    "navigation.estimate trimmer.estimate; navigation.estimate guidance.estimate;"
    "heading.held helm.held"
)


@pytest.mark.parametrize(
    ("rig", "terminals"),
    [
        ("hydrone-course", HOLDS),
        (
            "videoray-course",
            f"{HOLDS}; guidance.wanted depth_hold.wanted; depth_hold.held helm.held",
        ),
        (
            "videoray-hold",
            "depth_hold.held allocation.demand; heading_hold.held allocation.demand",
        ),
        ("gloria-course", SAILING),
        ("gloria", "navigation.estimate heading.estimate; navigation.estimate trimmer.estimate"),
        ("mariner", "reference.reference autopilot.wanted"),
    ],
)
def test_pilots_join_as_the_rigs_connect_them(rig, terminals):
    pilot = Terminals(rig, ("control",))
    assert pilot.joined(terminals) == pilot.connected()
