"""serial-gateway: serial bytes out to programs and devices, and theirs in."""

from seatrial.fmi.slave import Slave
from seatrial.links.serial_gateway import SerialGateway


class SerialGatewayFmu(Slave):
    """FMU of `SerialGateway`."""

    component_class = SerialGateway

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
