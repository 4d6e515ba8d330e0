"""helm: autopilots, sticks or nobody."""

from seatrial.control.helm import Helm
from seatrial.fmi.slave import Slave


class HelmFmu(Slave):
    """FMU of `Helm`."""

    component_class = Helm

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
