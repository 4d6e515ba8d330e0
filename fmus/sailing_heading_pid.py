"""sailing-heading-pid: heading of a sailing boat by a PID law."""

from seatrial.control.sailing_heading_pid import SailingHeadingPid
from seatrial.fmi.slave import Slave


class SailingHeadingPidFmu(Slave):
    """FMU of `SailingHeadingPid`."""

    component_class = SailingHeadingPid

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
