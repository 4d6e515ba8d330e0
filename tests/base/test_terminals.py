"""Names of terminals, next to those of ports."""

from typing import ClassVar

import pytest

from seatrial.model.component import Component, Output, Parameter, terminal


def test_a_terminal_may_be_called_as_a_parameter_that_stays():
    class Link(Component):
        failures = Parameter("gps", "1", "units")
        failure = Output("1", "of the receiver", type=str)
        terminals: ClassVar = {"failures": terminal(gps="failure")}

    assert Link.terminals["failures"].members == {"gps": "failure"}


@pytest.mark.parametrize("tunable", [True, False])
def test_a_terminal_is_not_called_as_what_can_be_connected(tunable):
    with pytest.raises(TypeError, match=r"Pilot\.gain is a port and a terminal too"):

        class Pilot(Component):
            gain = Parameter(1.0, "1", "of it", tunable=True) if tunable else Output("1", "of it")
            terminals: ClassVar = {"gain": terminal(out="gain")}
