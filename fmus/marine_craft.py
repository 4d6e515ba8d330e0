"""marine-craft: six-degree-of-freedom surface or submerged craft."""

from seatrial.craft.marine_craft import MarineCraft
from seatrial.fmi.slave import Slave


class MarineCraftFmu(Slave):
    """FMU of `MarineCraft`."""

    component_class = MarineCraft

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
