"""Names of ports and their axes, ours and those of other people's FMUs."""

import pytest

from seatrial.system.paths import split_axis


@pytest.mark.parametrize(
    ("scalar", "expected"),
    [
        ("position.x", ("position", "x")),
        ("speed", ("speed", "")),
        ("plant.pump.flow", ("plant.pump", "flow")),
        ("plant.pump.flow[3]", ("plant.pump.flow[3]", "")),
        ("der(plant.x)", ("der(plant.x)", "")),
        (".hidden", (".hidden", "")),
    ],
)
def test_a_scalar_is_of_a_port_with_an_axis_or_a_port_itself(scalar, expected):
    assert split_axis(scalar) == expected
