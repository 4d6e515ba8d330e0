"""anemometer: speed and direction of the apparent wind."""

from seatrial.devices.anemometer import Anemometer
from seatrial.fmi.slave import Slave


class AnemometerFmu(Slave):
    """FMU of `Anemometer`."""

    component_class = Anemometer

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
