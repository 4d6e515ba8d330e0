"""dynamic-positioning: position and heading held by three forces."""

from seatrial.control.dynamic_positioning import DynamicPositioning
from seatrial.fmi.slave import Slave


class DynamicPositioningFmu(Slave):
    """FMU of `DynamicPositioning`."""

    component_class = DynamicPositioning

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
