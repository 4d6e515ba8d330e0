"""Declarations of ports: layout, inheritance, types, limits; and what is refused."""

from __future__ import annotations

import csv
import io
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.model.component import Component, Input, Noise, Output, Parameter
from seatrial.model.plant import Plant
from seatrial.model.ports import lay_out
from seatrial.model.sampled import Sampled


class Hull(Component):
    """Kinds out of order, vectors between scalars."""

    force = Output("N", "force", axes="xyz")
    mass = Parameter(10.0, "kg", "mass", min=0.1)
    speed = Input("m/s", "speed", start=1.5)
    name_of_sea = Parameter("calm", "1", "sea", choices=("calm", "rough"))
    count = Output("1", "count", type=int)
    wind = Input("m/s", "wind", axes=("north", "east"), start=(1, 2))
    pad = Parameter((1.0, 2.0), "m", "pad", axes="xy")


def names(cls: type[Component]) -> list[str]:
    return [scalar.name for scalar in cls.scalars]


# ---------------------------------------------------------------------- layout


def test_parameters_then_inputs_then_outputs_each_as_declared() -> None:
    assert names(Hull) == [
        *("mass", "name_of_sea", "pad.x", "pad.y"),
        *("speed", "wind.north", "wind.east"),
        *("force.x", "force.y", "force.z", "count"),
    ]
    assert [s.reference for s in Hull.scalars] == list(range(11))
    assert Hull("it").values == [10.0, "calm", 1.0, 2.0, 1.5, 1.0, 2.0, 0.0, 0.0, 0.0, 0]


def test_a_unit_for_all_axes_or_one_for_each() -> None:
    class Pose(Component):
        place = Output("m", "place", axes="xy")
        pose = Output(("m", "m", "rad"), "pose", axes=("x", "y", "psi"))
        heel = Parameter((0.1, 0.2), ("rad", "rad/s"), "heel", axes="ab", max=(1.0, 2.0))

    assert [s.unit for s in Pose.scalars] == ["rad", "rad/s", "m", "m", "m", "m", "rad"]
    pose = Pose("it")
    pose.set("heel.b", 3.0)
    with pytest.raises(InputError, match=r"it\.heel\.b is 3\.0 rad/s, allowed at most 2\.0 rad/s"):
        pose.initialise()


PORTS = st.lists(
    st.tuples(st.sampled_from((Parameter, Input, Output)), st.integers(0, 4)), max_size=12
)


@given(PORTS)
def test_layout_of_any_ports_is_a_stable_sort_by_kind(described) -> None:
    ports, expected = {}, []
    for number, (kind, size) in enumerate(described):
        axes = [f"a{i}" for i in range(size)] or None
        start = (0.0,) if kind is Parameter else ()
        name = f"p{number}"
        ports[name] = kind(*start, "1", "a port", axes=axes)
        ports[name].__set_name__(Hull, name)
        rank = (Parameter, Input, Output).index(kind)
        expected += [(rank, f"{name}.{a}" if axes else name) for a in axes or [""]]
    placed, scalars = lay_out(ports)
    assert [s.name for s in scalars] == [n for _, n in sorted(expected, key=lambda e: e[0])]
    assert [s.reference for s in scalars] == list(range(len(scalars)))
    for port in placed.values():
        own = [s for s in scalars if s.port is port]
        assert [s.reference - port.offset for s in own] == list(range(port.size))
    assert all(port.offset == -1 for port in ports.values())  # the declarations are left alone


# ---------------------------------------------------------------------- inheritance


class Base(Component):
    gain = Parameter(1.0, "1", "gain")
    bias = Parameter(0.5, "m", "bias")
    y = Output("m", "y")


def test_a_subclass_inherits_and_adds() -> None:
    class More(Base):
        u = Input("m", "u")

    assert names(More) == ["gain", "bias", "u", "y"]
    assert names(Base) == ["gain", "bias", "y"]
    more, base = More("more"), Base("base")
    more.y, base.y = 4.0, 5.0  # at another place in each
    assert (more.get("y"), base.get("y")) == (4.0, 5.0)
    assert (more.values, base.values) == ([1.0, 0.5, 0, 4.0], [1.0, 0.5, 5.0])


def test_a_subclass_changes_a_default_for_itself_only() -> None:
    class Strong(Base):
        gain = Parameter(7.0, "1", "gain", max=9.0)

    class Stronger(Strong):
        y = Output("m", "y", nominal=3.0)

    assert [cls("it").get("gain") for cls in (Base, Strong, Stronger)] == [1.0, 7.0, 7.0]
    assert [cls.ports["gain"].max for cls in (Base, Strong, Stronger)] == [None, 9.0, 9.0]
    assert sorted(names(Strong)) == sorted(names(Base)) == sorted(names(Stronger))


def test_two_subclasses_do_not_mix() -> None:
    class Left(Base):
        left = Output("m", "left")

    class Right(Base):
        right = Input("rad", "right", type=int)

    assert set(Left.ports) - set(Right.ports) == {"left"}
    assert set(Right.ports) - set(Left.ports) == {"right"}
    right = Right("right")
    right.set("right", 3)
    assert right.get("right") == 3
    with pytest.raises(InputError, match=r"left is an output"):
        Left("left").set("left", 1.0)
    with pytest.raises(InputError, match="unknown port 'left'"):
        right.set("left", 1.0)
    a, b = Left("a"), Left("b")
    a.set("bias", -1.0)
    assert (b.get("bias"), Base("c").get("bias"), Base.ports["bias"].start) == (0.5, 0.5, [0.5])


def test_ports_follow_the_method_resolution_order() -> None:
    """As attributes do: the default that `class Both(Plain, Strong)` would inherit."""

    class Strong(Base):
        gain = Parameter(2.0, "1", "gain")

    class Plain(Base):
        z = Output("m", "z")

    class Both(Plain, Strong):
        pass

    class WouldBe:
        class Base:
            gain = 1.0

        class Strong(Base):
            gain = 2.0

        class Plain(Base):
            pass

    both = type("Both", (WouldBe.Plain, WouldBe.Strong), {})
    assert Both("it").get("gain") == both.gain == 2.0
    assert names(Both).count("gain") == 1


def test_a_mixin_brings_its_ports() -> None:
    class Sensor(Noise, Sampled):
        y = Output("m", "y")

    assert set(names(Sensor)) == {"seed", "period", "y"}


# ---------------------------------------------------------------------- declarations refused


@pytest.mark.parametrize(
    ("declare", "message"),
    [
        (lambda: Output("N", "force", axes=("x", "2y")), "axis '2y' is not an identifier"),
        (lambda: Output("N", "force", axes=("x", "")), "axis '' is not an identifier"),
        (lambda: Output("N", "force", axes=("x.y", "z")), "axis 'x.y' is not an identifier"),
        (lambda: Output("N", "force", axes="xyx"), "axes .* have the same name"),
        (
            lambda: Parameter((1.0, 2.0), "m", "pad", axes="xyz"),
            r"'pad' has 3 axes \(x, y, z\), got 2",
        ),
        (lambda: Parameter(True, "1", "flag"), "give 0.0 or 1.0 for a flag"),
        (lambda: Input("1", "u", type=complex), "float, int, bool or str, not <class 'complex'>"),
        (lambda: Input("1", "u", start="1"), "holds a number, got '1'"),
        (lambda: Input("1", "u", type=str, start=1), "holds text, got 1"),
        (lambda: Input("1", "u", type=int, start=1.5), "holds a whole number, got 1.5"),
        (
            lambda: Parameter((1.0, 2.0), "m", "pad", axes="xy", min=(0.0,)),
            "one element for each of 2",
        ),
        (lambda: Input("m", "u", axes="xy", nominal=(1.0, 2.0, 3.0)), "one element for each of 2"),
        (lambda: Output(("m", "rad"), "y", axes="xyz"), "one element for each of 3"),
    ],
)
def test_declarations_that_cannot_be(declare, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        declare()


def test_a_port_hides_nothing_and_nothing_hides_a_port() -> None:
    for reserved in ("name", "values", "step", "outputs", "now", "ports", "feedthrough"):
        with pytest.raises(TypeError, match=f"Odd.{reserved} is a port and something else too"):
            type("Odd", (Component,), {reserved: Output("1", "y")})
    with pytest.raises(TypeError, match=r"Odd\.gain is a port and something else too"):
        type("Odd", (Base,), {"gain": 5.0})  # would be ignored
    with pytest.raises(TypeError, match=r"Odd\.trim is a port and something else too"):
        type("Odd", (Plant,), {"trim": Output("1", "y")})


def test_one_port_object_has_one_name() -> None:
    with pytest.raises(TypeError, match="is the same port as"):

        class Odd(Component):
            a = b = Output("1", "twice")


@pytest.mark.parametrize(
    ("feedthrough", "message"),
    [
        ({"z": ("u",)}, "'z': no such output"),
        ({"y": ("v",)}, "'v': no such input"),
        ({"u": ("y",)}, "'u': no such output"),
        ({"y": ("y",)}, "'y': no such input"),
    ],
)
def test_feedthrough_names_ports_of_the_right_kind(feedthrough, message: str) -> None:
    ports = {"u": Input("1", "u"), "y": Output("1", "y"), "feedthrough": feedthrough}
    with pytest.raises(TypeError, match=message):
        type("Odd", (Component,), ports)


# ---------------------------------------------------------------------- values


@pytest.mark.parametrize(
    ("port", "value", "message"),
    [
        ("force", [1.0, 2.0], r"it\.force: port 'force' has 3 axes \(x, y, z\), got 2 values"),
        ("force", [1.0] * 4, "got 4 values"),
        ("force", [1.0, "2", 3.0], "holds a number, got '2'"),
        ("force", {"x": 1, "y": 2, "z": 3}, "holds a number, got 'x'"),
        ("speed", "fast", "holds a number, got 'fast'"),
        ("speed", [1.0], r"it\.speed: .*real number, not 'list'"),
        ("speed", None, "not 'NoneType'"),
        ("speed", 1j, "not 'complex'"),
        ("speed", 10**400, "too large"),
        ("label", 3, "holds text, got 3"),
        ("label", b"x", "holds text, got b'x'"),
        ("many", 2.5, "holds a whole number, got 2.5"),
        ("many", math.inf, "infinity"),
        ("many", math.nan, "NaN"),
    ],
)
def test_values_that_do_not_fit(port: str, value: object, message: str) -> None:
    class Takes(Component):
        force = Input("N", "force", axes="xyz")
        speed = Input("m/s", "speed")
        label = Input("1", "label", type=str)
        many = Input("1", "many", type=int)

    component = Takes("it")
    before = list(component.values)
    with pytest.raises(InputError, match=message):
        component.set(port, value)
    assert component.values == before


NUMPY = [np.float64(0.1), np.float32(0.1), np.int64(3), np.bool_(True), np.array(0.1)]


@pytest.mark.parametrize("value", NUMPY, ids=lambda v: f"{type(v).__name__}-{v}")
def test_numpy_values_become_pythons_own(value) -> None:
    class Takes(Component):
        u = Input("1", "u")
        y = Output("1", "y", axes="ab")
        n = Output("1", "n", type=int)
        b = Output("1", "b", type=bool)
        vector = Output("1", "vector", axes="abc")

    component = Takes("it")
    component.set("u", value)
    component.y = [value, value]
    component.n, component.b = int(value), value
    component.vector = np.full(3, value)
    assert {type(v) for v in component.values} == {float, int, bool}
    assert component.get("u") == float(value)
    # In a record an np.float64 would be 'np.float64(0.1)'.
    text = io.StringIO()
    csv.writer(text).writerow([repr(v) for v in component.values])
    assert "np." not in text.getvalue()


def test_numpy_defaults_become_pythons_own() -> None:
    class Takes(Component):
        p = Parameter(np.array([0.1, 0.2]), "1", "p", axes="ab")
        u = Input("1", "u", start=np.float64(0.3))

    assert [type(v) for v in Takes("it").values] == [float, float, float]
    assert Takes("it").values == [0.1, 0.2, 0.3]


def test_one_number_stands_for_every_axis() -> None:
    class Takes(Component):
        v = Input("m", "v", axes="xyz", start=2)
        label = Parameter("none", "1", "label", axes="ab")

    component = Takes("it")
    assert component.get("v") == [2.0] * 3
    assert component.get("label") == ["none"] * 2
    component.set("v", 3)
    assert component.get("v") == [3.0] * 3


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3))
def test_any_finite_vector_comes_back_bit_by_bit(values: list[float]) -> None:
    hull = Hull("it")
    hull.force = values
    assert [v.hex() for v in hull.get("force")] == [v.hex() for v in values]
    values[0] = 99.0  # neither the list given nor the one got is the component's own
    hull.get("force")[1] = 99.0
    assert [v.hex() for v in hull.force[1:]] == [v.hex() for v in values[1:]]


def test_limits_of_one_number_or_one_per_axis() -> None:
    class Limited(Component):
        a = Parameter((1.0, 2.0), "m", "a", axes="xy", min=0.0, max=(3.0, 4.0))
        b = Parameter(1.0, "m", "b", nominal=10.0)

    a, b = Limited.ports["a"], Limited.ports["b"]
    assert [a.limit("min", i) for i in (0, 1)] == [0.0, 0.0]
    assert [a.limit("max", i) for i in (0, 1)] == [3.0, 4.0]
    assert [a.limit("nominal", i) for i in (0, 1)] == [None, None]
    assert [b.limit(w, 0) for w in ("min", "max", "nominal")] == [None, None, 10.0]


@pytest.mark.parametrize(
    ("limits", "value", "message"),
    [
        ({"min": 1.0}, 0.5, r"it\.p\.x is 0\.5 m, allowed at least 1\.0 m"),
        ({"max": 2.0}, 2.5, r"it\.p\.x is 2\.5 m, allowed at most 2\.0 m"),
        ({"min": 1.0, "max": 2.0}, -1.0, r"it\.p\.x is -1\.0 m, allowed 1\.0 to 2\.0 m"),
        ({"min": (0.0, 1.0)}, 0.5, r"it\.p\.y is 0\.5 m, allowed at least 1\.0 m"),
    ],
)
def test_parameters_outside_their_limits(limits, value: float, message: str) -> None:
    cls = type("Limited", (Component,), {"p": Parameter(1.5, "m", "p", axes="xy", **limits)})
    component = cls("it")
    component.initialise()
    component.set("p", value)
    with pytest.raises(InputError, match=message):
        component.refresh()


def test_limits_themselves_are_allowed() -> None:
    class Limited(Component):
        p = Parameter(1.5, "m", "p", min=1.0, max=2.0)

    for value in (1.0, 2.0):
        component = Limited("it")
        component.set("p", value)
        component.initialise()
        assert component.get("p") == value
    for value in (np.nextafter(1.0, 0.0), np.nextafter(2.0, 3.0)):
        component = Limited("it")
        component.set("p", value)
        with pytest.raises(InputError, match="allowed"):
            component.initialise()


def test_choices_have_near_misses() -> None:
    hull = Hull("it")
    hull.set("name_of_sea", "ruogh")
    with pytest.raises(
        InputError, match=r"it\.unknown value of name_of_sea 'ruogh'; did you mean 'rough'"
    ):
        hull.initialise()
    hull.set("name_of_sea", "rough")
    hull.initialise()
