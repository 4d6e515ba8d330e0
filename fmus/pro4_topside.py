"""pro4-topside: the topside of a VideoRay Pro 4."""

from seatrial.fmi.slave import Slave
from seatrial.links.videoray.topside import Pro4Topside


class Pro4TopsideFmu(Slave):
    """FMU of `Pro4Topside`."""

    component_class = Pro4Topside

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
