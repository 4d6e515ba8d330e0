"""servo: hobby servo."""

from seatrial.devices.servo import Servo
from seatrial.fmi.slave import Slave


class ServoFmu(Slave):
    """FMU of `Servo`."""

    component_class = Servo

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
