"""pulse-allocation: forces to the pulses of two thrusters."""

from seatrial.control.pulse_allocation import PulseAllocation
from seatrial.fmi.slave import Slave


class PulseAllocationFmu(Slave):
    """FMU of `PulseAllocation`."""

    component_class = PulseAllocation

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
