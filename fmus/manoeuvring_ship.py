"""manoeuvring-ship: ship under way that its rudder steers."""

from seatrial.craft.manoeuvring_ship import ManoeuvringShip
from seatrial.fmi.slave import Slave


class ManoeuvringShipFmu(Slave):
    """FMU of `ManoeuvringShip`."""

    component_class = ManoeuvringShip

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
