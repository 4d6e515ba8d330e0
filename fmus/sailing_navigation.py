"""sailing-navigation: motion and true wind from a sailing boat's sensors."""

from seatrial.control.sailing_navigation import SailingNavigation
from seatrial.fmi.slave import Slave


class SailingNavigationFmu(Slave):
    """FMU of `SailingNavigation`."""

    component_class = SailingNavigation

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
