"""dronecan-autopilot: an autopilot's DroneCAN."""

from seatrial.fmi.slave import Slave
from seatrial.links.dronecan.autopilot import DroneCanAutopilot


class DroneCanAutopilotFmu(Slave):
    """FMU of `DroneCanAutopilot`."""

    component_class = DroneCanAutopilot

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
