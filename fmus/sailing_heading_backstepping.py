"""sailing-heading-backstepping: heading of a sailing boat by backstepping."""

from seatrial.control.sailing_heading_backstepping import SailingHeadingBackstepping
from seatrial.fmi.slave import Slave


class SailingHeadingBacksteppingFmu(Slave):
    """FMU of `SailingHeadingBackstepping`."""

    component_class = SailingHeadingBackstepping

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
