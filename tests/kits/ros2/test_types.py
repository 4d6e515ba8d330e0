"""Types and bytes against cyclonedds' own serialiser, and types that are typed by hand."""

from itertools import count

import pytest
from cyclonedds.idl import IdlStruct
from rosbags.interfaces import Nodetype

from seatrial_kits.ros2.dds.idl import sample_type
from seatrial_kits.ros2.messages.definitions import INTERFACES, dds_name, service_parts, type_store
from seatrial_kits.ros2.messages.packing import packed
from seatrial_kits.ros2.topics import COMMANDED, PUBLISHED

from . import peer

KINDS = sorted({each.kind for each in (*PUBLISHED.values(), *COMMANDED.values())})
COUNT = count(1)
SERVICES = [name for name in INTERFACES if "/srv/" in name]


@pytest.mark.parametrize("kind", [*KINDS, *(p for s in SERVICES for p in service_parts(s))])
def test_a_type_is_one_of_dds_with_the_definition_s_fields(kind):
    made = sample_type(kind)
    made.__idl__.populate()
    made.__idl__.fill_type_data()
    assert made.__idl_typename__ == dds_name(kind)
    assert [*made.__annotations__] == [name for name, _ in type_store().fielddefs[kind][1]]


def test_a_program_with_types_of_its_own_reads_the_bytes_and_writes_the_same():
    fields = {
        "header": {"stamp": 12_000_000_345, "frame_id": "odom"},
        "child_frame_id": "base_link",
        "pose": {
            "pose": {"position": (1.0, 2.0, 3.0), "orientation": (0.0, 0.6, 0.0, 0.8)},
            "covariance": [0.5 * i for i in range(36)],
        },
        "twist": {"twist": {"linear": (4.0, 5.0, 6.0), "angular": (7.0, 8.0, 9.0)}},
    }
    ours = sample_type("nav_msgs/msg/Odometry")(packed("nav_msgs/msg/Odometry", fields))
    theirs = peer.Odometry.deserialize(ours.serialize())
    assert theirs.header.stamp == peer.Time(12, 345)
    assert (theirs.header.frame_id, theirs.child_frame_id) == ("odom", "base_link")
    assert theirs.pose.pose.orientation == peer.Quaternion(0.0, 0.6, 0.0, 0.8)
    assert theirs.twist.twist == peer.Twist(peer.Vector3(4, 5, 6), peer.Vector3(7, 8, 9))
    again = theirs.serialize(use_version_2=False)
    assert again[4:] == ours.serialize()[4:]
    back = sample_type("nav_msgs/msg/Odometry").deserialize(again).message
    assert list(back.pose.covariance) == [0.5 * i for i in range(36)]


def test_the_type_names_are_those_of_the_hand():
    named = {
        each.__idl_typename__
        for each in vars(peer).values()
        if isinstance(each, type) and issubclass(each, IdlStruct) and each is not IdlStruct
    }
    assert "nav_msgs::msg::dds_::Odometry_" in named
    assert named <= {dds_name(kind).replace("/", "::") for kind in type_store().types}


def test_bytes_that_are_no_message_are_none():
    assert sample_type("nav_msgs/msg/Odometry").deserialize(b"\0\1\0\0\7").message is None


def test_a_field_that_is_not_there_is_a_mistake_of_ours():
    with pytest.raises(KeyError, match="anguler"):
        packed("geometry_msgs/msg/Twist", {"anguler": (0.0, 0.0, 0.0)})


def filled(entry, length):
    """A value of a field, and of the type's other fields, in which no two numbers are alike."""
    sort, what = entry
    if sort == Nodetype.NAME:
        return some(what, length)
    if sort == Nodetype.BASE:
        number = next(COUNT) % 100
        return {"string": "x" * length, "bool": bool(number % 2)}.get(what[0], number)
    inner, size = what
    return [filled(inner, length) for _ in range(size if sort == Nodetype.ARRAY else length)]


def some(kind, length):
    if kind == "builtin_interfaces/msg/Time":
        return next(COUNT) * 1_000_000_007
    return {name: filled(entry, length) for name, entry in type_store().fielddefs[kind][1]}


@pytest.mark.parametrize("length", [0, 1, 2, 3])
@pytest.mark.parametrize("kind", [*KINDS, *(p for s in SERVICES for p in service_parts(s))])
def test_bytes_are_those_of_another_serialiser(kind, length):
    """rosbags reads them, and writes the same bytes again; what is not given is 0."""
    store = type_store()
    for values in (some(kind, length), {}):
        data = packed(kind, values)
        assert bytes(store.serialize_cdr(store.deserialize_cdr(data, kind), kind)) == data


@pytest.mark.parametrize("values", [{"covariance": [1.0]}, {"covariance": [1.0] * 37}])
def test_an_array_of_another_length_is_a_mistake_of_ours(values):
    with pytest.raises(ValueError, match="36 are needed"):
        packed("geometry_msgs/msg/PoseWithCovariance", values)
