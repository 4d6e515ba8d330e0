"""dronecan-peripheral: ESCs, servos, receivers on a DroneCAN bus."""

from seatrial.fmi.slave import Slave
from seatrial.links.dronecan.peripheral import DroneCanPeripheral


class DroneCanPeripheralFmu(Slave):
    """FMU of `DroneCanPeripheral`."""

    component_class = DroneCanPeripheral

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
