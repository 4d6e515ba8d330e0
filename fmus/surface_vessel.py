"""surface-vessel: underwater vehicle at constant depth, in surge, sway and yaw."""

from seatrial.craft.surface_vessel import SurfaceVessel
from seatrial.fmi.slave import Slave


class SurfaceVesselFmu(Slave):
    """FMU of `SurfaceVessel`."""

    component_class = SurfaceVessel

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
