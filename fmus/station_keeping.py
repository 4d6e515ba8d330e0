"""station-keeping: autopilot holding position and heading with two thrusters."""

from seatrial.control.station_keeping import StationKeeping
from seatrial.fmi.slave import Slave


class StationKeepingFmu(Slave):
    """FMU of `StationKeeping`."""

    component_class = StationKeeping

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
