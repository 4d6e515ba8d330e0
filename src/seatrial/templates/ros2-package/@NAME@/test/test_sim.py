"""The trial's criteria as a test: seatrial run ends with 1 if one does not hold."""

import unittest
from pathlib import Path

import launch_testing
import pytest
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

LAUNCH = Path(__file__).parents[1] / "launch/sim.launch.py"


@pytest.mark.launch_test
def generate_test_description():
    simulation = IncludeLaunchDescription(PythonLaunchDescriptionSource(str(LAUNCH)))
    return LaunchDescription([simulation, launch_testing.actions.ReadyToTest()])


class CriteriaHold(unittest.TestCase):
    def test_the_trial_ends(self, proc_info):
        proc_info.assertWaitForShutdown(process="seatrial", timeout=600.0)


@launch_testing.post_shutdown_test()
class Status(unittest.TestCase):
    def test_status(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info, process="seatrial")
