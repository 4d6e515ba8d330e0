"""ahrs: attitude and heading reference with accelerometers."""

from seatrial.devices.ahrs import Ahrs
from seatrial.fmi.slave import Slave


class AhrsFmu(Slave):
    """FMU of `Ahrs`."""

    component_class = Ahrs

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
