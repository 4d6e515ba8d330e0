"""nmea0183: NMEA 0183 sentences to and from instruments, chart plotters and autopilots."""

from seatrial.fmi.slave import Slave
from seatrial.links.nmea0183.component import Nmea0183


class Nmea0183Fmu(Slave):
    """FMU of `Nmea0183`."""

    component_class = Nmea0183

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
