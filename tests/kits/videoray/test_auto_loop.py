"""The ROV's own loops against their equation, at every heading."""

import math

import pytest

from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.auto_loop import AutoLoop

from .bench import make_node

GAINS = (0.06, 0.004, 0.8)
"""P, I and D as captured, 0x2E.. of the map."""
FACTOR = 0.1
PATH = [-5.7, -4.2, -1.1, 1.9, 2.5, -0.6, -1.4, 2.0]
"""Headings relative to the target, deg: across it and back."""


def outputs(target, half):
    """Return output and terms of the heading loop, step by step along PATH."""
    node, loop, found = make_node(), AutoLoop("auto_heading", "heading", 360.0), []
    csr.put(node.memory, "auto_heading_target", target)
    for off in PATH:
        heading = (target + off) % 360.0
        node.measure("heading", heading - 360.0 if half and heading >= 180.0 else heading)
        output = loop.run(node)
        found.append((output, *(node.value(f"auto_heading_{x}_term") for x in "pid")))
    return found


@pytest.mark.parametrize("half", [False, True], ids=["0 to 360", "-180 to 180"])
@pytest.mark.parametrize("target", [0, 3, 90, 177, 180, 184, 270, 355, 359])
def test_the_heading_loop_is_its_equation_at_every_heading(target, half):
    """K (P e + I sum(e) + D (e - e_before)), e = target - heading, whatever the target."""
    total, before = 0.0, PATH[0]
    for off, (output, p, i, d) in zip(PATH, outputs(target, half=half), strict=True):
        total -= off
        errors = (-off, total, before - off)
        expected = [gain * error for gain, error in zip(GAINS, errors, strict=True)]
        before = off
        assert (p, i, d) == pytest.approx(expected, abs=6e-5)  # a term counts tenths of 1e-3
        assert output == pytest.approx(FACTOR * sum(expected), abs=1e-9)


@pytest.mark.parametrize("target", [0, 90, 180, 300])
def test_the_shorter_way_is_taken_and_ends_where_both_are_as_long(target):
    node, loop = make_node(), AutoLoop("auto_heading", "heading", 360.0)
    csr.put(node.memory, "auto_heading_target", target)
    for off in (-179.0, -90.0, -1.0, 1.0, 90.0, 179.0):
        node.measure("heading", (target + off) % 360.0)
        loop.rest(node)
        assert math.copysign(1.0, loop.run(node)) == math.copysign(1.0, -off)


def test_a_depth_loop_does_not_wrap():
    node, loop = make_node(), AutoLoop("auto_depth", "pressure")
    csr.put(node.memory, "auto_depth_target", 1500)
    for name, raw in (("p", 1000), ("i", 0), ("d", 0), ("k", 10)):
        csr.put(node.memory, f"auto_depth_{name}", raw)
    node.measure("pressure", 1100.0)
    assert loop.run(node) == pytest.approx(0.1 * 400 * 0.001)
