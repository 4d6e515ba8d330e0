"""The product's KVLCC2 under a helmsman who samples the heading, against the recorded zig-zags."""

import math

import numpy as np
import pytest

from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.zigzag import zig_zag
from tests.craft.references import shipped

from .references import FIGURES
from .test_figures import assert_as_reference

COARSE, SAMPLE = 0.1, 2e-4
"""Steps, s, away from the heading of a reversal and near to it."""
LENGTHS = {"model": 7.0, "ship": 320.0}


def sailed(variant, angle):
    """Return the record of a zig-zag from t = 0, and the times at which the helm was reversed."""
    vessel = shipped("mmg-ship", "kvlcc2.mmg-ship", variant, propeller_order=1.0)
    vessel.initialise()
    vessel.begin()
    rate = math.radians(2.34) * math.sqrt(320.0 / LENGTHS[variant])
    time, helm, side, reversals, rows = 0.0, 0.0, 1.0, [], []
    while len(reversals) < 5:
        (north, east, psi), (_, _, r) = vessel.get("eta"), vessel.get("nu")
        if not rows or time - rows[-1][0] > 0.9 * COARSE:
            rows.append((time, north, east, psi, helm))
        if side * psi >= abs(angle):
            reversals.append(time)
            side = -side
        step = SAMPLE if side * (psi + 2.0 * COARSE * r) >= abs(angle) else COARSE
        moved = side * angle - helm
        if moved:
            step = min(step, abs(moved) / rate)  # to the end of the rudder's ramp
        after = helm + math.copysign(min(abs(moved), rate * step), moved)
        vessel.set("rudder", -(helm + after) / 2.0)
        vessel.advance(time, step)
        time, helm = time + step, after
    return Record(*np.transpose(rows)), reversals


@pytest.mark.parametrize(
    ("name", "variant"),
    [("kvlcc2_l7_zigzag_10_10", "model"), ("kvlcc2_full_zigzag_20_20", "ship")],
)
def test_a_sampled_helm_reverses_within_a_sample_and_gives_the_figures(name, variant):
    angle = math.radians(FIGURES[name]["heading_deg"])
    record, reversals = sailed(variant, angle)
    exact = FIGURES[name]["figures"]["execute_times_exact"]
    # Each is up to a sample late, and the next one begins as late.
    late = np.subtract(reversals[: len(exact)], exact)
    assert np.abs(late).max() <= len(exact) * SAMPLE
    assert_as_reference(name, zig_zag(record, angle, 0.0))
