"""nmea2000-node: a node of an NMEA 2000 network."""

from seatrial.fmi.slave import Slave
from seatrial.links.nmea2000.component import Nmea2000


class Nmea2000Fmu(Slave):
    """FMU of `Nmea2000`."""

    component_class = Nmea2000

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
