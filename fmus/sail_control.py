"""sail-control: angle of a rigid sail and its flap."""

from seatrial.control.sail_control import SailControl
from seatrial.fmi.slave import Slave


class SailControlFmu(Slave):
    """FMU of `SailControl`."""

    component_class = SailControl

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
