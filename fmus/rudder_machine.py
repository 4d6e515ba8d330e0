"""rudder-machine: steering gear with limits of angle and rate."""

from seatrial.devices.rudder_machine import RudderMachine
from seatrial.fmi.slave import Slave


class RudderMachineFmu(Slave):
    """FMU of `RudderMachine`."""

    component_class = RudderMachine

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
