"""heading-reference: reference model of the heading."""

from seatrial.control.reference_filter import HeadingReference
from seatrial.fmi.slave import Slave


class HeadingReferenceFmu(Slave):
    """FMU of `HeadingReference`."""

    component_class = HeadingReference

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
