"""can-traffic: a node that loads a CAN bus."""

from seatrial.fmi.slave import Slave
from seatrial.links.can.traffic import CanTraffic


class CanTrafficFmu(Slave):
    """FMU of `CanTraffic`."""

    component_class = CanTraffic

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
