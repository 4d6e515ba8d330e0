"""thruster-ship: ship in surge, sway and yaw under thrusters."""

from seatrial.craft.thruster_ship import ThrusterShip
from seatrial.fmi.slave import Slave


class ThrusterShipFmu(Slave):
    """FMU of `ThrusterShip`."""

    component_class = ThrusterShip

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
