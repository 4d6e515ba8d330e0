"""rov: remotely operated underwater vehicle on its tether."""

from seatrial.craft.rov import Rov
from seatrial.fmi.slave import Slave


class RovFmu(Slave):
    """FMU of `Rov`."""

    component_class = Rov

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
