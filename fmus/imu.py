"""imu: gyro, accelerometer and attitude solution."""

from seatrial.devices.imu import Imu
from seatrial.fmi.slave import Slave


class ImuFmu(Slave):
    """FMU of `Imu`."""

    component_class = Imu

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
