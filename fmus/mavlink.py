"""mavlink: a vehicle that ground stations see, command and guide."""

from seatrial.fmi.slave import Slave
from seatrial.links.mavlink.component import Mavlink


class MavlinkFmu(Slave):
    """FMU of `Mavlink`."""

    component_class = Mavlink

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
