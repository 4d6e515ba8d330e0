"""downwash: load of a multirotor landing on a deck or taking off from it."""

from seatrial.environment.downwash import Downwash
from seatrial.fmi.slave import Slave


class DownwashFmu(Slave):
    """FMU of `Downwash`."""

    component_class = Downwash

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
