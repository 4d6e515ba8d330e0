"""The communication step of a rig that says none is the shortest of the rigs inside it."""

import pytest

from seatrial.errors import InputError
from seatrial.system.flattening import load_rig

SOURCE = "time,x\n0,1\n1,2\n"


@pytest.fixture
def step_ns(write):
    """Return a function: the step of a rig with two inside, by what each of the three says."""

    def step_ns(outer, first, second):
        write("values.csv", SOURCE)
        for name, said in (("first", first), ("second", second)):
            write(f"{name}.toml", f'{said}\n[components]\na = {{ fmu = "values.csv" }}\n')
        rigs = "".join(f'{name} = {{ rig = "{name}.toml" }}\n' for name in ("first", "second"))
        return load_rig(str(write("outer.toml", f"{outer}\n[components]\n{rigs}"))).step_ns

    return step_ns


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (("", 'step = "100 ms"', 'step = "0.02 s"'), 20_000_000),
        (('step = ""', 'step = "100 ms"', ""), 100_000_000),
        (('step = "1 s"', 'step = "100 ms"', ""), 1_000_000_000),
    ],
)
def test_the_shortest_step_inside_holds_where_the_outer_says_none(step_ns, said, expected):
    assert step_ns(*said) == expected


def test_a_rig_without_any_step_is_refused(step_ns):
    with pytest.raises(InputError, match="step: this key is missing, and no rig inside has one"):
        step_ns("", "", "")
