"""rudder-helm: who has the helm of a craft with a rudder."""

from seatrial.control.rudder_helm import RudderHelm
from seatrial.fmi.slave import Slave


class RudderHelmFmu(Slave):
    """FMU of `RudderHelm`."""

    component_class = RudderHelm

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
