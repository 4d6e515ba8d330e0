"""compass: magnetic compass."""

from seatrial.devices.compass import Compass
from seatrial.fmi.slave import Slave


class CompassFmu(Slave):
    """FMU of `Compass`."""

    component_class = Compass

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
