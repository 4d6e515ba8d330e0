"""course: a course over waypoints, leg by leg."""

from seatrial.control.course import Course
from seatrial.fmi.slave import Slave


class CourseFmu(Slave):
    """FMU of `Course`."""

    component_class = Course

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
