"""angle-servo: servo commanded by an angle."""

from seatrial.devices.angle_servo import AngleServo
from seatrial.fmi.slave import Slave


class AngleServoFmu(Slave):
    """FMU of `AngleServo`."""

    component_class = AngleServo

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
