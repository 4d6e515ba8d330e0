"""can-signals: a node of a CAN bus whose messages a DBC describes."""

from seatrial.fmi.slave import Slave
from seatrial.links.can_signals.component import CanSignals


class CanSignalsFmu(Slave):
    """FMU of `CanSignals`."""

    component_class = CanSignals

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
