"""thruster: T200 thruster with its speed controller."""

from seatrial.devices.thruster import Thruster
from seatrial.fmi.slave import Slave


class ThrusterFmu(Slave):
    """FMU of `Thruster`."""

    component_class = Thruster

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
