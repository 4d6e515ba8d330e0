import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.devices.actuators.propulsion import Propulsion
from seatrial.errors import InputError

from .running import started

D_HULL, X, Z = 0.4, -0.45, 0.15  # m


def catamaran():
    """Thruster 1 to port, thruster 2 to starboard, below and abaft the body origin."""
    return started(
        Propulsion,
        position_1=[X, -D_HULL, Z],
        position_2=[X, D_HULL, Z],
        direction_1=[1, 0, 0],
        direction_2=[1, 0, 0],
    )


@pytest.mark.parametrize(("port", "starboard"), [(10, 0), (0, 10), (10, 10), (10, -7), (-5, -5)])
def test_catamaran_with_the_corrected_signs(port, starboard):
    craft = catamaran()
    craft.set("thrust", [port, starboard, *[0] * 14])
    assert craft.get("force") == [port + starboard, 0, 0]
    k, m, n = craft.get("moment")
    assert k == 0
    assert m == pytest.approx(Z * (port + starboard))
    assert n == pytest.approx((port - starboard) * D_HULL)


def test_port_thruster_ahead_turns_the_bow_to_starboard():
    craft = catamaran()
    craft.set("thrust.t1", 1.0)
    assert craft.get("moment.z") > 0.0


def test_absent_thrusters_do_nothing():
    craft = catamaran()
    craft.set("thrust", [0, 0, *[99, -99] * 7])
    assert craft.get("force") + craft.get("moment") == [0.0] * 6


numbers = st.floats(-5, 5)
triples = st.tuples(numbers, numbers, numbers)


@given(st.lists(st.tuples(triples, triples, st.floats(-100, 100)), min_size=16, max_size=16))
def test_is_the_sum_of_r_cross_f(thrusters):
    values, force, moment, thrusts = {}, np.zeros(3), np.zeros(3), []
    for i, (position, direction, thrust) in enumerate(thrusters, 1):
        length = np.linalg.norm(direction)
        unit = np.array(direction) / length if length > 1e-3 else np.zeros(3)
        values |= {f"position_{i}": position, f"direction_{i}": unit.tolist()}
        force += unit * thrust
        moment += np.cross(position, unit * thrust)
        thrusts.append(thrust)
    craft = started(Propulsion, **values, thrust=thrusts)
    assert craft.get("force") == pytest.approx(force, abs=1e-9)
    assert craft.get("moment") == pytest.approx(moment, abs=1e-9)


def test_refuses_a_direction_that_is_no_unit_vector():
    with pytest.raises(InputError, match=r"direction_3 .* of length 1\.41421"):
        started(Propulsion, direction_3=[1, 1, 0])


def test_eight_thrusters_act_on_all_six_axes():
    """A vectored ROV: four at 45 degrees in the horizontal plane, four vertical ones."""
    h = np.sqrt(0.5)
    directions = [[h, s * h, 0] for s in (1, -1, -1, 1)] + [[0, 0, -1]] * 4
    corners = [[x, y, 0.05] for x in (0.15, -0.15) for y in (-0.1, 0.1)]
    values = {f"direction_{i}": d for i, d in enumerate(directions, 1)}
    values |= {f"position_{i}": p for i, p in enumerate(2 * corners, 1)}
    craft = started(Propulsion, **values)
    effects = []
    for thruster in range(8):
        craft.set("thrust", [float(thruster == i) for i in range(16)])
        effects.append(craft.get("force") + craft.get("moment"))
    assert np.linalg.matrix_rank(effects) == 6
