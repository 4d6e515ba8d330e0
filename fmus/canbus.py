"""canbus: a CAN bus in exact simulated time."""

from seatrial.fmi.slave import Slave
from seatrial.links.can.component import CanBus


class CanBusFmu(Slave):
    """FMU of `CanBus`."""

    component_class = CanBus

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
