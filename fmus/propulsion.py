"""propulsion: force and moment of up to four thrusters."""

from seatrial.devices.propulsion import Propulsion
from seatrial.fmi.slave import Slave


class PropulsionFmu(Slave):
    """FMU of `Propulsion`."""

    component_class = Propulsion

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
