"""tether: cable between the surface and a vehicle, in a current."""

from seatrial.craft.tether import Tether
from seatrial.fmi.slave import Slave


class TetherFmu(Slave):
    """FMU of `Tether`."""

    component_class = Tether

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
