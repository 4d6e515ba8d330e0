"""linear-thruster: thruster with thrust linear in a command from -1 to 1."""

from seatrial.devices.linear_thruster import LinearThruster
from seatrial.fmi.slave import Slave


class LinearThrusterFmu(Slave):
    """FMU of `LinearThruster`."""

    component_class = LinearThruster

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
