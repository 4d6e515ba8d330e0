"""force-actuator: thrusters of a ship as one force and one moment."""

from seatrial.devices.force_actuator import ForceActuator
from seatrial.fmi.slave import Slave


class ForceActuatorFmu(Slave):
    """FMU of `ForceActuator`."""

    component_class = ForceActuator

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
