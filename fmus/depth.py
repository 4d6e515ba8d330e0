"""depth: depth from water pressure."""

from seatrial.devices.depth import Depth
from seatrial.fmi.slave import Slave


class DepthFmu(Slave):
    """FMU of `Depth`."""

    component_class = Depth

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
