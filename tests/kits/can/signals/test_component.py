"""Ports to frames and back, evaluated by canmatrix, which reads DBCs itself."""

import math
import re
import struct
from pathlib import Path

import canmatrix.formats
import pytest

from seatrial.errors import InputError
from seatrial.shipped import shipped_folder
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.signals.component import CanSignals

from .bench import Bench, signals

ODD = Path(__file__).parent / "odd.dbc"
GLORIA = shipped_folder("harness") / "kits/sailing/profiles/gloria.dbc"
HYDRONE = shipped_folder("hil_profiles") / "hydrone.dbc"
DEG = math.pi / 180.0


def reference(path):
    return canmatrix.formats.loadp_flat(str(path))


def decoded(path, frame):
    """Return what canmatrix reads in a frame: physical values."""
    known = reference(path).frame_by_id(
        canmatrix.ArbitrationId(frame.identifier, extended=frame.extended)
    )
    return {name: float(value.phys_value) for name, value in known.decode(frame.data).items()}


def test_all_layouts_are_as_another_reader_has_them():
    """Motorola and Intel, signed, float, offsets, 29 bits; units to SI by hand."""
    node = signals(ODD, sends="Mixed.Big; Mixed.Across; Mixed.Exact; Long.Share", cycle_time=0.1)
    rpm = 2.0 * math.pi / 60.0
    for value in ((-123.25, 250.5, -3.5, 12.5), (400.0, 3999.5, 1e-3, 100.0), (0, 273.15, 0, 0)):
        big, across, exact, share = value
        node.set("send", [big * rpm, across + 273.15, exact, share / 100.0, *[0.0] * 12])
        bench = Bench(node)
        bench.run(0.2)
        mixed = [frame for _, frame in bench.peer.received if frame.identifier == 291][-1]
        found = decoded(ODD, mixed)
        assert found["Big"] == pytest.approx(big, abs=0.126)
        assert found["Across"] == pytest.approx(across, abs=0.251)
        assert found["Exact"] == pytest.approx(exact, rel=1e-6)
        assert found["Spare"] == 9.0
        long = [frame for _, frame in bench.peer.received if frame.extended][-1]
        assert long.identifier == 2566844926 - 2**31
        assert decoded(ODD, long)["Share"] == pytest.approx(share)
        node = signals(
            ODD, sends="Mixed.Big; Mixed.Across; Mixed.Exact; Long.Share", cycle_time=0.1
        )


def test_frames_that_another_encoder_made_are_read():
    there = reference(GLORIA).frame_by_name("ServoStatus")
    raw = {"RudderAngle": -1199, "SailAngle": 4567, "FlapAngle": 3000}
    node = signals(GLORIA, receives="; ".join(f"ServoStatus.{name}" for name in raw))
    bench = Bench(node)
    bench.run(0.05, [Frame(400, there.encode(raw))])
    for value, counts in zip(node.get("received"), raw.values(), strict=False):
        assert value == pytest.approx(counts * 0.01 * DEG, abs=1e-12)
    assert node.get("valid")[:4] == [True, True, True, False]
    assert node.get("frames_received") == 1


def test_what_is_multiplexed_arrives_one_by_one():
    there = reference(ODD).frame_by_name("Parts")
    node = signals(ODD, receives="Parts.Volts; Parts.Amps")
    assert node.get("received")[:2] == [pytest.approx(12.0), 0.0]  # GenSigStartValue
    bench = Bench(node)
    bench.run(0.02, [Frame(293, there.encode({"Which": 1, "Amps": -21}))])
    assert node.get("received")[:2] == [pytest.approx(12.0), -10.5]
    bench.run(0.02, [Frame(293, there.encode({"Which": 0, "Volts": 119}))])
    assert node.get("received")[:2] == [pytest.approx(11.9), -10.5]


def test_cycles_are_those_of_the_dbc_whatever_the_step():
    for step_ns in (1_000_000, 7_000_000):
        node = signals(GLORIA, sends="ServoCommand.Rudder")
        bench = Bench(node, step_ns=step_ns)
        bench.run(0.5)
        bits = bench.peer.received[0][0]  # the first begins at the start of the run
        assert 80_000 < bits < 260_000
        for number, (when, _) in enumerate(bench.peer.received):
            assert when - bits == number * 20_000_000
        assert len(bench.peer.received) in (23, 24, 25)


def test_a_message_without_cycle_goes_out_when_it_changes():
    node = signals(ODD, sends="Long.Share")
    bench = Bench(node)
    bench.run(0.1)
    node.set("send.s1", 0.5)
    bench.run(0.1)
    node.set("send.s1", 0.5001)  # less than half a step of the scaling: the same bytes
    bench.run(0.1)
    node.set("send.s1", 0.9)
    bench.run(0.1)
    assert [frame.data[0] for _, frame in bench.peer.received] == [0, 100, 180]
    assert node.get("frames_sent") == 3


def test_values_beyond_the_limits_are_limited_and_counted():
    node = signals(GLORIA, sends="ServoCommand.Rudder; ServoCommand.Flap")
    node.set("send", [-20.0 * DEG, 12.0 * DEG, *[0.0] * 14])
    bench = Bench(node)
    bench.run(0.1)
    found = decoded(GLORIA, bench.peer.received[-1][1])
    assert (found["Rudder"], found["Flap"], found["Sail"]) == (-12.0, 12.0, 90.0)
    assert node.get("limited") == node.get("frames_sent") == 5
    node.set("send", [12.0 * DEG, 30.0 * DEG, *[0.0] * 14])  # the very limits are none beyond
    bench.run(0.1)
    assert node.get("limited") == 5


def test_what_is_not_received_for_three_cycles_is_lost():
    node = signals(HYDRONE, receives="ThrusterCommand.PortPulse 1100 1900 us")
    bench = Bench(node, step_ns=1_000_000)
    command = Frame(256, (15000).to_bytes(2, "little") * 2)
    bench.run(0.01, [command])
    assert node.get("received.s1") == pytest.approx(1.5e-3)
    bench.run(0.05)
    assert node.get("valid.s1")
    bench.run(0.01)
    assert not node.get("valid.s1")
    assert node.get("received.s1") == 0.0
    bench.run(0.01, [command])
    assert node.get("valid.s1")
    steady = signals(HYDRONE, receives="ThrusterCommand.PortPulse", lost_after=0.0)
    bench = Bench(steady)
    bench.run(0.05, [command])
    bench.run(1.0)
    assert steady.get("valid.s1")


def test_frames_that_are_not_as_the_dbc_says_change_nothing():
    node = signals(HYDRONE, receives="ThrusterCommand.PortPulse")
    bench = Bench(node)
    wrong = [
        Frame(256, bytes(3)),
        Frame(256, bytes(5)),
        Frame(256, remote=True, requested=4),
        Frame(256, bytes(4), extended=True),  # another message
        Frame(257, bytes(4)),
    ]
    bench.run(0.1, wrong)
    assert node.get("frames_refused") == 3
    assert node.get("frames_received") == 0
    assert not node.get("valid.s1")


def test_a_float_that_is_none_changes_nothing():
    node = signals(ODD, receives="Mixed.Exact")
    bench = Bench(node)
    bench.run(0.05, [Frame(291, bytes(4) + struct.pack("<f", 2.5))])
    bench.run(0.05, [Frame(291, bytes(4) + struct.pack("<f", v)) for v in (math.nan, -math.inf)])
    assert node.get("received.s1") == 2.5
    assert (node.get("frames_received"), node.get("frames_refused")) == (1, 2)


def test_a_restored_node_goes_on_as_it_did():
    node = signals(ODD, sends="Mixed.Big; Long.Share", receives="Parts.Amps")
    Bench(node).run(0.1)
    state, at = node.get_state(), 0.1

    def goes_on(one):
        sent = []
        for k in range(20):
            one.set("send.s1", 0.1 * k)
            one.advance(at + 0.01 * k, 0.01)
            sent.append((one.get("tx"), one.get("frames_sent"), one.get("limited")))
        return sent

    first = goes_on(node)
    other = CanSignals("node")
    other.set_state(state)
    assert goes_on(other) == first


TEXT = HYDRONE.read_text("utf-8")
SENDS = "ThrusterCommand.PortPulse 1100 1900 us"


@pytest.mark.parametrize(
    ("change", "sends", "expected"),
    [
        (("", ""), "ThrusterCommand.PortPuls", ["sends", "did you mean 'PortPulse'"]),
        (("", ""), "ThrusterComand.PortPulse", ["did you mean 'ThrusterCommand'"]),
        (("", ""), "PortPulse", ["'PortPulse' is not MESSAGE.SIGNAL"]),
        (("", ""), f"{SENDS}; {SENDS}", ["ThrusterCommand.PortPulse is named twice"]),
        (("", ""), "ThrusterCommand.PortPulse 1 2 V", ["'V' cannot be converted to 'us'"]),
        (
            ("", ""),
            "ThrusterCommand.PortPulse 1.1 2.6 ms",
            ["carries 0 to 2500 us", "1.1 to 2.6 ms"],
        ),
        (("(0.1,0) [0|2500]", "(0.01,0) [0|0]"), SENDS, ["carries 0 to 655.35 us", "1100 to 1900"]),
        (("(0.1,0) [0|2500]", "(0,0) [0|2500]"), SENDS, ["PortPulse", "scaling (0,0)"]),
        (("(0.1,0) [0|2500]", "(1e300,0) [0|2500]"), SENDS, ["PortPulse", "scaling (1e+300,0)"]),
        (("BO_ 256 ThrusterCommand: 4", "BO_ 256 ThrusterCommand: 9"), SENDS, ["9 bytes", "8 at"]),
        (("BO_ 256 20;", "BO_ 256 -20;"), SENDS, ["GenMsgCycleTime is -20"]),
        (
            ("BO_ 386 StarboardStatus", "BO_ 256 StarboardStatus"),
            f"{SENDS}; StarboardStatus.StarboardCurrent",
            ["ThrusterCommand and StarboardStatus", "0x100"],
        ),
        (
            ("BO_ 386 StarboardStatus", "BO_ 386 ThrusterCommand"),
            SENDS,
            ["ThrusterCommand stands twice, in lines "],
        ),
        (("16|16@1+", "8|16@1+"), SENDS, ["overlapping", "ThrusterCommand"]),
        (("4 Autopilot", "3 Autopilot"), SENDS, ["does not fit"]),
        (("SG_ PortPulse", "SG PortPulse"), SENDS, ["not a usable DBC", "line 14"]),
        (('"us"', '"parsec2000"'), SENDS, ["PortPulse", "'parsec2000' is not a unit"]),
    ],
)
def test_mistakes_name_the_file(tmp_path, change, sends, expected):
    file = tmp_path / "bus.dbc"
    file.write_text(TEXT.replace(*change) if change[0] else TEXT, "utf-8")
    with pytest.raises(InputError) as caught:
        signals(file, sends=sends)
    for part in expected:
        assert part in str(caught.value)
    named = re.match(r"node: (sends|database): ", str(caught.value))
    assert named, str(caught.value)
    if "named twice" not in expected[0] and "is not MESSAGE" not in expected[0]:
        assert str(file) in str(caught.value)


def test_mistakes_that_no_file_has(tmp_path):
    with pytest.raises(InputError, match=r"absent\.dbc: No such file"):
        signals(tmp_path / "absent.dbc", sends=SENDS)
    with pytest.raises(InputError, match="node: sends: there are signals, but no database"):
        signals("", sends=SENDS)
    with pytest.raises(InputError, match="Parts is multiplexed"):
        signals(ODD, sends="Parts.Volts")
    with pytest.raises(InputError, match="ThrusterCommand is received too"):
        signals(HYDRONE, sends=SENDS, receives="ThrusterCommand.StarboardPulse")
    (tmp_path / "noise.dbc").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match=r"noise\.dbc: not a usable DBC"):
        signals(tmp_path / "noise.dbc", sends=SENDS)
