"""Gains of a sailing boat's heading that change during a run, as those of the other autopilots."""

import pytest

from seatrial_kits.sailing.control.heading_pid import SailingHeadingPid
from tests.control.test_tuning import moves_as_the_gain_means, unchanged_without_an_error

LOOP = ("heading_wanted", "heading", "yaw_moment", {"rudder_limit": 1e6}, 0.02)


@pytest.mark.parametrize("gain", ["K_p", "K_i", "K_d"])
def test_without_an_error_a_new_gain_changes_nothing(gain):
    unchanged_without_an_error(SailingHeadingPid, gain, LOOP)


def test_with_an_error_the_output_moves_by_what_the_gain_means():
    # K_p of the law, its error 0.02: the same for new and old, as the docstring has it.
    moves_as_the_gain_means(
        SailingHeadingPid, "K_p", 50.0, lambda old: (50.0 - old["K_p"]) * 0.02, LOOP
    )
