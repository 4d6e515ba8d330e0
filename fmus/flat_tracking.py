"""flat-tracking: velocities of a vessel held by its flat outputs."""

from seatrial.control.flat_tracking import FlatTracking
from seatrial.fmi.slave import Slave


class FlatTrackingFmu(Slave):
    """FMU of `FlatTracking`."""

    component_class = FlatTracking

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
