"""speed-hold: speed ahead held by the propulsion."""

from seatrial.control.speed_hold import SpeedHold
from seatrial.fmi.slave import Slave


class SpeedHoldFmu(Slave):
    """FMU of `SpeedHold`."""

    component_class = SpeedHold

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
