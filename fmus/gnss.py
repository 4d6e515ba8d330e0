"""gnss: satellite positioning receiver."""

from seatrial.devices.gnss import Gnss
from seatrial.fmi.slave import Slave


class GnssFmu(Slave):
    """FMU of `Gnss`."""

    component_class = Gnss

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
