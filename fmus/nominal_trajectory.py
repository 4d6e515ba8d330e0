"""nominal-trajectory: velocities for a vessel to follow, and the commands that give them."""

from seatrial.control.nominal_trajectory import NominalTrajectory
from seatrial.fmi.slave import Slave


class NominalTrajectoryFmu(Slave):
    """FMU of `NominalTrajectory`."""

    component_class = NominalTrajectory

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
