"""heading-hold: heading of an underwater vehicle."""

from seatrial.control.heading_hold import HeadingHold
from seatrial.fmi.slave import Slave


class HeadingHoldFmu(Slave):
    """FMU of `HeadingHold`."""

    component_class = HeadingHold

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
