"""sailing-guidance: guidance of a sailing boat that wears round."""

from seatrial.control.sailing_guidance import SailingGuidance
from seatrial.fmi.slave import Slave


class SailingGuidanceFmu(Slave):
    """FMU of `SailingGuidance`."""

    component_class = SailingGuidance

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
