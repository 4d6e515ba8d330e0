"""thruster-allocation: forces wanted to commands of three thrusters."""

from seatrial.control.thruster_allocation import ThrusterAllocation
from seatrial.fmi.slave import Slave


class ThrusterAllocationFmu(Slave):
    """FMU of `ThrusterAllocation`."""

    component_class = ThrusterAllocation

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
