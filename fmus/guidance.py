"""guidance: where to head, how fast, how deep."""

from seatrial.control.guidance import Guidance
from seatrial.fmi.slave import Slave


class GuidanceFmu(Slave):
    """FMU of `Guidance`."""

    component_class = Guidance

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
