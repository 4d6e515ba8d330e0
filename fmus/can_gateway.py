"""can-gateway: a CAN bus's door to programs and hardware outside."""

from seatrial.fmi.slave import Slave
from seatrial.links.can.component_gateway import CanGateway


class CanGatewayFmu(Slave):
    """FMU of `CanGateway`."""

    component_class = CanGateway

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
