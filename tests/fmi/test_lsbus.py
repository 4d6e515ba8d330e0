"""FMI-LS-BUS: a CAN node in C on the simulated bus, with another of its kind and with our own."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import pytest
from typer.testing import CliRunner

from seatrial import Simulation
from seatrial.errors import InputError, SimulationError
from seatrial.fmi.files.terminals import PLACE
from seatrial.fmi.loading.load import load_fmu
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.can.frame import Frame
from seatrial_kits.interchange.command_osp import osp_app
from seatrial_kits.interchange.command_ssp import ssp_app
from seatrial_kits.interchange.ssp.reading import read_ssp
from tests.kits.can.reference_bits import classic

from ..command import seatrial
from ..kits.interchange.ssp_natives import component, connection, elements, package, ssd
from .native import changed

CLASSIC, EXTENDED, REMOTE, FD, WAKEUP, NONSENSE = range(6)
RIG = """
step = "{step}"

[components]
a   = {{ fmu = "{a}"{more} }}
b   = {{ fmu = "{b}" }}
can = {{ fmu = "canbus", set = {{ nodes = "a b", watched = "0x123"{bus} }} }}

[connections]
"a.bus" = "can.n1"
"b.bus" = "can.n2"
"""


@pytest.fixture
def rig(native_fmu, write):
    """Return a function that writes a rig of two nodes in C."""

    def rig(*, step: str = "1 ms", bus: str = "", more: str = "", a=None) -> Path:
        node = native_fmu("cannode")
        return write("rig.toml", RIG.format(a=a or node, b=node, step=step, bus=bus, more=more))

    return rig


@pytest.fixture
def surprising(native_fmu, tmp_path: Path) -> Path:
    """Return a node whose transmit clock is a triggered output."""
    return changed(
        native_fmu("cannode"), tmp_path / "surprising.fmu",
        ('causality="input" intervalVariability="countdown"', 'causality="output" intervalVariability="triggered"'),
    )  # fmt: skip


def read(simulation: Simulation, *names: str) -> list[object]:
    return [simulation.get(name) for name in names]


def test_describe_shows_what_is_joined(rig, tmp_path: Path) -> None:
    done = seatrial("describe", str(rig()), cwd=tmp_path)
    lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert {"can.rx.n1 -> a.rx.bus", "a.tx.bus -> can.tx.n1", "b.tx.bus -> can.tx.n2"} <= {*lines}


SENDS = {"a.id": 0x123, "a.frames": 5, "a.value": 0x0807060504030201}


@pytest.mark.parametrize("isolated", ["", ", isolated = true"])
def test_two_nodes_of_others_talk(rig, isolated: str) -> None:
    with Simulation(rig(more=isolated), engine="fmu", set=SENDS) as simulation:
        simulation.run(0.1)
        assert read(simulation, "a.confirmed", "b.received", "a.received", "b.confirmed") == [
            5,
            5,
            0,
            0,
        ]
        assert read(simulation, "b.last_id", "b.last_kind", "b.last_size") == [0x123, CLASSIC, 8]
        assert simulation.get("b.last_value") == SENDS["a.value"]
        # Requested at 50 ms, sent after its bits; received in the step after that of the bus.
        bits = len(classic(Frame(0x123, bytes(range(1, 9)))))
        assert simulation.get("can.latency.l1") == pytest.approx(bits / 250e3, abs=1e-12)
        assert simulation.get("b.when") == pytest.approx(0.052)


def test_a_clock_that_surprises_sends_at_the_same_times(rig, surprising: Path) -> None:
    path = rig(a=surprising, step="7 ms")
    with Simulation(
        path, engine="fmu", set={**SENDS, "a.first": 0.0105, "a.surprises": True}
    ) as simulation:
        simulation.run(0.14)
        assert read(simulation, "a.confirmed", "b.received") == [5, 5]
        bits = len(classic(Frame(0x123, bytes(range(1, 9)))))
        assert simulation.get("can.latency.l1") == pytest.approx(bits / 250e3, abs=1e-12)


@pytest.mark.parametrize(
    ("settings", "received"),
    [
        ({"id": 0x1ABCDEF0, "kind": EXTENDED, "size": 3}, [0x1ABCDEF0, EXTENDED, 3, 0x030201]),
        ({"id": 0x7FF, "kind": REMOTE, "size": 4}, [0x7FF, REMOTE, 4]),
        ({"id": 0x7FF, "kind": REMOTE, "size": 0}, [0x7FF, REMOTE, 0]),
        ({"id": 5, "kind": FD, "size": 64}, [5, FD, 64, 0x0807060504030201]),
    ],
)
def test_frames_of_every_kind(rig, settings, received) -> None:
    values = {**SENDS, **{f"a.{name}": value for name, value in settings.items()}}
    with Simulation(rig(), engine="fmu", set=values) as simulation:
        simulation.run(0.1)
        assert read(simulation, "a.confirmed", "b.received") == [5, 5]
        last = read(simulation, "b.last_id", "b.last_kind", "b.last_size", "b.last_value")
        assert last[: len(received)] == received


def test_many_operations_come_in_portions_that_fit(rig) -> None:
    """20 frames of 24 bytes end in one step of 20 ms; the node takes 100 bytes at once."""
    values = {**SENDS, "a.frames": 20, "a.period": 0.0007}
    with Simulation(rig(step="20 ms"), engine="fmu", set=values) as simulation:
        simulation.run(0.1)
        assert read(simulation, "a.confirmed", "b.received") == [20, 20]


@pytest.mark.parametrize(("discards", "counts"), [(True, [5, 0, 5, 5]), (False, [5, 5, 0, 10])])
def test_the_lower_identifier_wins(rig, discards: bool, counts: list[int]) -> None:
    """Both ask at the same times: the loser's frames wait, or it is notified that they were given up."""
    both = {**SENDS, "b.frames": 5, "b.id": 0x124, "b.discards": discards}
    with Simulation(rig(), engine="fmu", set=both) as simulation:
        simulation.run(0.1)
        names = ("a.confirmed", "b.confirmed", "b.lost", "can.frames")
        assert read(simulation, *names) == counts


def test_a_broken_transmitter_is_notified_of_each_error_until_it_is_off_the_bus(rig) -> None:
    """Each error adds 8 to its counter; it goes off above 255."""
    with Simulation(rig(bus=', recovery = "off"'), engine="fmu", set=SENDS) as simulation:
        simulation.inject("defective", "can.n1")
        simulation.run(0.1)
        attempts = math.ceil(256 / 8)
        names = (
            "a.errors",
            "a.own_errors",
            "b.errors",
            "b.own_errors",
            "b.received",
            "a.confirmed",
        )
        assert read(simulation, *names) == [attempts, attempts, attempts, 0, 0, 0]
        assert simulation.get("can.state.n1") == 3


def test_what_is_no_operation_comes_back(rig) -> None:
    with Simulation(rig(), engine="fmu", set={**SENDS, "a.kind": NONSENSE}) as simulation:
        simulation.run(0.1)
        assert read(simulation, "a.format_errors", "a.last_size", "b.received") == [5, 11, 0]


def test_a_wake_up_reaches_the_others(rig) -> None:
    with Simulation(rig(), engine="fmu", set={**SENDS, "a.kind": WAKEUP}) as simulation:
        simulation.run(0.1)
        assert read(simulation, "a.wakeups", "b.wakeups") == [0, 5]


def test_another_bit_rate_is_refused_with_the_nodes_name(rig) -> None:
    with Simulation(rig(), engine="fmu", set={"b.bit_rate": 500_000}) as simulation:
        message = "can: node 'b' has 500000 bit/s, the bus's bit_rate is 250000"
        with pytest.raises(SimulationError, match=message):
            simulation.run(0.1)


def test_a_node_is_saved_and_restored_with_all_that_is_on_its_way(rig) -> None:
    with Simulation(rig(), engine="fmu", set={**SENDS, "b.frames": 5, "b.id": 0x124}) as simulation:
        names = ("a.confirmed", "b.received", "b.confirmed", "b.when", "can.tx.n1", "a.rx.bus")
        for k in range(1, 30):
            simulation.run(k * 0.002)
            state = simulation.save()
            simulation.run(0.1)
            end = read(simulation, *names)
            simulation.restore(state)
            del state
            assert end[:3] == [5, 5, 5]
        simulation.run(0.1)
        assert read(simulation, *names) == end


@pytest.mark.parametrize("kind", ["countdown", "triggered"])
def test_the_log_does_not_depend_on_the_step(rig, surprising, write, tmp_path, kind) -> None:
    """A node asks at its own times inside a step, so the bus has the same frames at the same times."""
    trial = write("t.toml", 'rig = "rig.toml"\nstop = "60 ms"\n')
    logs = []
    values = "id = 0x123, frames = 5, first = 0.0123, period = 0.0007"
    if kind == "triggered":
        values += ", surprises = true"
    for name, step in (("fine", "1 ms"), ("coarse", "10 ms")):
        rig(
            step=step,
            a=surprising if kind == "triggered" else None,
            more=f", set = {{ {values} }}",
        )
        result = run_trial(load_trial(str(trial)), tmp_path / name, engine="fmu")
        assert result.status == "complete", result.error
        logs.append((result.folder / "can.log").read_text().splitlines())
    assert logs[0] == logs[1]
    assert len(logs[0]) == 5


NMEA2000 = """
step = "5 ms"

[components]
compass = {{ fmu = "{node}" }}
pilot   = {{ fmu = "nmea2000-node" }}
can     = {{ fmu = "canbus", set = {{ nodes = "compass pilot" }} }}

[connections]
"compass.bus" = "can.n1"
"pilot.bus"   = "can.n2"
"""


def test_a_node_of_nmea_2000_and_an_fmu_receive_each_other(native_fmu, write) -> None:
    """PGN 127250 from address 35: sequence, heading in 1e-4 rad, deviation, variation, true."""
    heading = 1.2345
    data = struct.pack("<BHhhB", 0, round(heading * 1e4), 0x7FFF, 0x7FFF, 0xFC)
    values = {
        "compass.id": 0x09F11223, "compass.kind": EXTENDED, "compass.frames": 30, "compass.first": 0.6,
        "compass.period": 0.1, "compass.value": int.from_bytes(data, "little", signed=True),
    }  # fmt: skip
    path = write("rig.toml", NMEA2000.format(node=native_fmu("cannode")))
    with Simulation(path, engine="fmu", set=values) as simulation:
        simulation.run(2.0)
        assert simulation.get("pilot.bus_heading") == pytest.approx(heading, abs=0.5e-4)
        # It claims an address, 60928, at least, and says its heart beats, 126993.
        assert simulation.get("compass.received") == simulation.get("can.sent.n2") > 0
        assert simulation.get("compass.last_id") & 0xFF == simulation.get("pilot.claimed_address")


def test_two_nodes_are_connected_without_a_bus(native_fmu, write) -> None:
    """Then nothing takes time, and nobody confirms."""
    rig = """
    step = "10 ms"
    [components]
    a = {{ fmu = "{node}" }}
    b = {{ fmu = "{node}" }}
    [connections]
    "a.tx.bus" = "b.rx.bus"
    "b.tx.bus" = "a.rx.bus"
    """
    path = write("rig.toml", rig.format(node=native_fmu("cannode")))
    with Simulation(path, engine="fmu", set={**SENDS, "b.frames": 3}) as simulation:
        simulation.run(0.1)
        assert read(simulation, "b.received", "a.received", "a.confirmed") == [5, 3, 0]


# ------------------------------------------------------------------ what cannot be


@pytest.mark.parametrize("member", ["Data", "Clock"])
def test_packages_that_connect_data_and_clocks_are_refused(native_fmu, tmp_path, member) -> None:
    node = native_fmu("cannode")
    inside = elements(
        component("a", fmu="cannode"),
        component("b", fmu="cannode"),
        connections=connection(f"a/Tx_{member}", f"b/Rx_{member}"),
    )
    members = {"resources/cannode.fmu": node.read_bytes()}
    path = package(tmp_path / "x.ssp", ssd(inside, version="2.0"), members)
    message = f"line 3: connections of clocks, .* are not supported: 'Tx_{member}'"
    with pytest.raises(InputError, match=message):
        read_ssp(path)


@pytest.mark.parametrize("package", ["ssp", "osp"])
def test_packages_refuse_ports_that_others_do_not_find(rig, tmp_path: Path, package: str) -> None:
    to = tmp_path / "package"
    apps = {"ssp": ssp_app, "osp": osp_app}
    result = CliRunner().invoke(apps[package], ["export", str(rig()), "--out", str(to)])
    assert isinstance(result.exception, InputError)
    assert str(result.exception).startswith("a.rx.bus is a port that seatrial makes of a bus ")
    assert not to.exists()


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('memberName="Rx_Clock"', 'memberName="Clock"', "has no Rx_Clock; Rx_Data, Rx_Clock, Tx_"),
        ('variableName="Rx_Clock"', 'variableName="id"', "id is no clock"),
        (
            'variableName="Rx_Clock"',
            'variableName="Tx_Clock"',
            "Rx_Clock: a triggered input is nee",
        ),
        (
            'variableName="Tx_Data"',
            'variableName="received"',
            "Tx_Data: one Binary output of the cl",
        ),
    ],
)
def test_terminals_that_cannot_be(native_fmu, tmp_path: Path, before, after, message) -> None:
    path = changed(native_fmu("cannode"), tmp_path / "x.fmu", (before, after), member=PLACE)
    with pytest.raises(
        InputError, match=rf"x\.fmu: {PLACE}: bus terminal 'bus' \(line 4\): {message}"
    ):
        load_fmu(path)


def test_another_bus_is_a_note(native_fmu, tmp_path: Path) -> None:
    path = changed(native_fmu("cannode"), tmp_path / "x.fmu", ("ls-bus.can", "ls-bus.flexray"))
    fmu = load_fmu(path)
    assert fmu.buses == []
    (note,) = fmu.notes
    other = "application/org.fmi-standard.fmi-ls-bus.flexray"
    assert note.startswith(f"bus terminal 'bus' has {other}, only ")
    assert {"Rx_Data", "Tx_Data", "Rx_Clock"} <= fmu.variables.keys()
