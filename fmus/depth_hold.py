"""depth-hold: depth of an underwater vehicle."""

from seatrial.control.depth_hold import DepthHold
from seatrial.fmi.slave import Slave


class DepthHoldFmu(Slave):
    """FMU of `DepthHold`."""

    component_class = DepthHold

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
