"""heading-autopilot: heading control of a ship by its rudder."""

from seatrial.control.heading_autopilot import HeadingAutopilot
from seatrial.fmi.slave import Slave


class HeadingAutopilotFmu(Slave):
    """FMU of `HeadingAutopilot`."""

    component_class = HeadingAutopilot

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
