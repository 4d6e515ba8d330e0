"""computed-torque: velocities of a vessel held by computed torque."""

from seatrial.control.computed_torque import ComputedTorque
from seatrial.fmi.slave import Slave


class ComputedTorqueFmu(Slave):
    """FMU of `ComputedTorque`."""

    component_class = ComputedTorque

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
