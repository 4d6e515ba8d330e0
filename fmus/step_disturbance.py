"""step-disturbance: load or sensor error that comes suddenly and goes."""

from seatrial.environment.step_disturbance import StepDisturbance
from seatrial.fmi.slave import Slave


class StepDisturbanceFmu(Slave):
    """FMU of `StepDisturbance`."""

    component_class = StepDisturbance

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
