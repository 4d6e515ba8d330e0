"""arduino: an Arduino board with a sketch, simulated, emulated or real."""

from seatrial.fmi.slave import Slave
from seatrial.links.arduino.component import Arduino


class ArduinoFmu(Slave):
    """FMU of `Arduino`."""

    component_class = Arduino

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
