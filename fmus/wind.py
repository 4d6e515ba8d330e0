"""wind: uniform wind with gusts."""

from seatrial.environment.wind import Wind
from seatrial.fmi.slave import Slave


class WindFmu(Slave):
    """FMU of `Wind`."""

    component_class = Wind

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
