"""pro4-rov: a VideoRay Pro 4 at its serial line."""

from seatrial.fmi.slave import Slave
from seatrial.links.videoray.rov import Pro4Rov


class Pro4RovFmu(Slave):
    """FMU of `Pro4Rov`."""

    component_class = Pro4Rov

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
