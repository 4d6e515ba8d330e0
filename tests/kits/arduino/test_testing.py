"""The other ends of links in a simulation: UART and pins, CAN, MAVLink, Pro 4."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.testing.bench import Bench
from seatrial_kits.arduino.testing import sketch_rig

SKETCH = Path(__file__).parents[2] / "testing/sketches/rudder/rudder.ino"
DBC = """VERSION ""

NS_ :

BS_:

BU_: Bridge Horn

BO_ 528 HornCommand: 2 Bridge
 SG_ Level : 0|8@1+ (0.5,0) [0|100] "%" Horn
 SG_ Turn : 8|8@1- (1,0) [-90|90] "deg" Horn

BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 528 50;
"""
CAN_RIG = """
step = "5 ms"

[components]
can    = { fmu = "canbus", set = { nodes = "bridge horn test" } }
bridge = { fmu = "can-signals", set = { database = "DBC", sends = "HornCommand.Level" } }
horn   = { fmu = "can-signals", set = { database = "DBC", receives = "HornCommand.Turn" } }

[connections]
"bridge.tx" = "can.tx.n1"
"horn.tx"   = "can.tx.n2"
"can.rx.n1" = "bridge.rx"
"can.rx.n2" = "horn.rx"
"""
ROV_RIG = """
step = "10 ms"

[components]
rov = { fmu = "pro4-rov" }
"""


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("board")
    rig = sketch_rig(SKETCH, folder, {"wires": "9 servo 1; 3 pwm 1; A0 voltage 1"})
    with Bench(rig) as bench:
        yield bench.board("board")


def test_a_sketch_is_asked_and_answers(board) -> None:
    sim = board.simulation
    assert board.expect("READY", within="2 s").endswith(b"READY")
    board.send("H60\n")
    board.expect("OK", within="1 s")
    sim.run(sim.time + 0.04)
    assert board.pin(9).pulse == pytest.approx(1560e-6)
    board.send("H10\n")
    board.send("H-120\n")
    board.expect("OK", within="1 s")
    board.expect("OK", within="1 s")
    sim.run(sim.time + 0.04)
    assert board.pin(9).pulse == pytest.approx(1380e-6)
    assert board.pin("9").pulse == board.pin(9).pulse
    board.send("X\n")
    with pytest.raises(AssertionError, match=r"did not say b'OK' .* it said .*ERR"):
        board.expect("OK", within="50 ms")
    board.pin("A0").voltage = 2.5
    assert sim.get("board.voltage.v1") == 2.5
    sim.assert_holds('eventually board.tx.uart0 says "ERR"')
    with pytest.raises(AssertionError, match="worst 1560 us"):
        sim.assert_holds("board.pulse.s1 < 1550 us")


def test_pins_say_what_they_have(board) -> None:
    with pytest.raises(InputError, match="nothing is connected to pin 8"):
        board.pin(8)
    with pytest.raises(AttributeError, match=r"'pwm' has no 'pulse' here \(it has: duty\)"):
        _ = board.pin(3).pulse
    with pytest.raises(AttributeError, match="'servo' has no 'pulse' here"):
        board.pin(9).pulse = 1e-3


@pytest.fixture
def can(tmp_path: Path):
    (tmp_path / "horn.dbc").write_text(DBC)
    (tmp_path / "loud.toml").write_text(CAN_RIG.replace("DBC", str(tmp_path / "horn.dbc")))
    with Bench(tmp_path / "loud.toml", set={"bridge.send.s1": 0.25}) as bench:
        yield bench.bus("can", database=tmp_path / "horn.dbc")


def test_frames_and_signals_of_a_bus(can) -> None:
    frame = can.expect(0x210, within="0.1 s")
    assert frame.data == bytes([50, 0])  # 25 % in halves of a per cent
    assert can.expect("HornCommand.Level", within="0.1 s") == 25.0
    can.simulation.set("bridge.send.s1", 0.5)
    assert can.expect("HornCommand.Level", within="0.2 s", where=lambda level: level > 40) == 50.0
    with pytest.raises(AssertionError, match=r"0x7FF was not received .*0x210 64 00"):
        can.expect(0x7FF, within="60 ms")
    with pytest.raises(InputError, match="HornCommand"):
        can.expect("HornCommand.Levle")


def test_a_test_sends_from_a_node_of_its_own(can) -> None:
    can.simulation.override("bridge.tx", "")
    can.send(0x210, bytes([0, 45]))
    can.simulation.run("50 ms")
    assert can.simulation.get("horn.received.s1") == pytest.approx(0.7853982)
    assert can.simulation.get("horn.valid.s1")


def test_a_bus_without_a_free_node_refuses(tmp_path: Path) -> None:
    (tmp_path / "horn.dbc").write_text(DBC)
    (tmp_path / "loud.toml").write_text(
        CAN_RIG.replace("DBC", str(tmp_path / "horn.dbc")).replace(" test", "")
    )
    with Bench(tmp_path / "loud.toml") as bench, pytest.raises(InputError, match="one more"):
        bench.bus("can").send(0x100, b"")


def test_a_vehicle_is_a_mavlink_peer() -> None:
    choices = {"vehicle": "hydrone", "autopilot": "mavlink"}
    with Bench("sil", choices=choices, mavlink="autopilot.mavlink") as bench:
        vehicle = bench.vehicle
        beat = vehicle.expect("HEARTBEAT", within="3 s")
        assert beat.get_srcSystem() == 1
        bench.run("6 s")  # its receiver has a position then
        vehicle.mav.command_long_send(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
        answer = vehicle.expect("COMMAND_ACK", within="1 s", command=400)
        assert answer.result == 0
        assert bench.get("autopilot.mavlink.armed")
        bench.assert_holds("abs(vehicle.motion.attitude.phi) < 10 deg")
        with pytest.raises(AssertionError, match=r"HEARTBEAT, type=99 was not received"):
            vehicle.expect("HEARTBEAT", within="1.5 s", type=99)


def test_a_rig_without_a_named_vehicle_has_none(tmp_path: Path) -> None:
    (tmp_path / "rov.toml").write_text(ROV_RIG)
    with Bench(tmp_path / "rov.toml") as bench, pytest.raises(InputError, match="mavlink="):
        _ = bench.vehicle


def test_a_pro_4_answers_requests(tmp_path: Path) -> None:
    (tmp_path / "rov.toml").write_text(ROV_RIG)
    with Bench(tmp_path / "rov.toml") as bench:
        rov = bench.pro4("rov")
        rov.read(0, 8)
        answer = rov.expect(within="0.1 s")
        assert answer.is_response
        assert answer.id == 1
        assert len(answer.payload) == 1 + 8  # the type of device, and what was asked for
        with pytest.raises(AssertionError, match="a response, address=3 was not received"):
            rov.expect(within="0.1 s", address=3)
