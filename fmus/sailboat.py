"""sailboat: boat with a rigid sail in surge, sway, roll and yaw."""

from seatrial.craft.sailboat import Sailboat
from seatrial.fmi.slave import Slave


class SailboatFmu(Slave):
    """FMU of `Sailboat`."""

    component_class = Sailboat

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
