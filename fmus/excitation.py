"""excitation: random commands, to identify a vehicle's axes."""

from seatrial.fmi.slave import Slave
from seatrial.identification.excitation import Excitation


class ExcitationFmu(Slave):
    """FMU of `Excitation`."""

    component_class = Excitation

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
