"""m5-thrusters: VideoRay M5 thrusters on a VRCSR line."""

from seatrial.fmi.slave import Slave
from seatrial.links.videoray.m5_thrusters import M5Thrusters


class M5ThrustersFmu(Slave):
    """FMU of `M5Thrusters`."""

    component_class = M5Thrusters

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
