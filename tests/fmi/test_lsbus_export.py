"""FMI-LS-BUS outwards: our CAN components of FMI 3.0 on other importers' buses, and event mode.

Operations are written out as FMI-LS-BUS 1.0 for CAN has them (network abstraction, 4.4.1).
"""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import fmpy
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from lxml import etree

from seatrial import Simulation
from seatrial.errors import InputError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.components.index import components
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.fmi.files.terminals import PLACE
from seatrial.fmi.loading.load import load_fmu
from seatrial.fmi.version3.buses import can_terminals
from seatrial.fmi.version3.sources import front_sources
from seatrial.model.component import Component, Input, Output, terminal
from tests.fmi.native import changed
from tests.kit import needs_kits

pytestmark = [
    needs_kits("can"),
    pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux"),
]

SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
MANIFEST = "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml"
MANIFESTS = "{http://fmi-standard.org/fmi-ls-manifest}fmi-ls-"
DBC = """VERSION ""
NS_ :
BS_:
BU_: A B
BO_ 1 M: 4 A
 SG_ X : 0|8@1+ (1,0) [0|255] "" B
BO_ 2 R: 2 B
 SG_ Y : 0|16@1+ (1,0) [0|65535] "" A
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 1 100;
BA_ "GenMsgCycleTime" BO_ 2 200;
"""


def transmit(identifier: int, data: bytes) -> bytes:
    """Return CAN Transmit: code, length, identifier, IDE, RTR, size, data."""
    return struct.pack("<IIIBBH", 0x10, 16 + len(data), identifier, 0, 0, len(data)) + data


def confirm(identifier: int) -> bytes:
    return struct.pack("<III", 0x20, 12, identifier)


def configured(bit_rate: int) -> bytes:
    """Return Configuration of the bit rate of CAN."""
    return struct.pack("<IIBI", 0x40, 13, 1, bit_rate)


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a function that builds an FMU of FMI 3.0."""
    folder = tmp_path_factory.mktemp("fmus")

    def build(name: str) -> Path:
        source = find_source(name, Path.cwd())
        assert isinstance(source, ComponentSource)
        path = folder / f"{source.name}.fmu"
        if not path.is_file():
            build_fmu(source, path, None, 3, (HERE,), library_here)
        return path

    return build


@pytest.fixture
def dbc(write) -> Path:
    return write("bus.dbc", DBC)


class Peer:
    """An FMU that FMPy calls as an importer with buses does."""

    def __init__(
        self, path: Path, folder: Path, values: Mapping[str, Any] | None = None, events: bool = True
    ) -> None:
        model = fmpy.read_model_description(str(path))
        self.messages: list[str] = []
        self.reference = {v.name: v.valueReference for v in model.modelVariables}
        self.fmu = FMU3Slave(
            guid=model.guid,
            unzipDirectory=fmpy.extract(str(path), str(folder / path.stem)),
            modelIdentifier=model.coSimulation.modelIdentifier,
            instanceName=path.stem,
        )
        self.fmu.instantiate(
            eventModeUsed=events,
            logMessage=lambda _e, _s, _c, text: self.messages.append(text.decode()),
        )
        for name, value in (values or {}).items():
            put = self.fmu.setString if isinstance(value, str) else self.fmu.setFloat64
            put([self.reference[name]], [value])
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()

    def sent(self, name: str) -> bytes:
        """Return the operations that a terminal sends in this event."""
        if not self.fmu.getClock([self.reference[f"{name}.Tx_Clock"]])[0]:
            return b""
        return bytes(self.fmu.getBinary([self.reference[f"{name}.Tx_Data"]])[0])

    def receive(self, name: str, operations: bytes) -> None:
        self.fmu.setClock([self.reference[f"{name}.Rx_Clock"]], [True])
        self.fmu.setBinary([self.reference[f"{name}.Rx_Data"]], [operations])

    def step(self, t: float, h: float) -> bool:
        """Step; return whether there is an event."""
        return bool(self.fmu.doStep(t, h)[0])

    def count(self, name: str, elements: int = 1) -> list[int]:
        return list(self.fmu.getInt32([self.reference[name]], elements))


End = tuple[Peer, str]


def exchanged(connected: list[tuple[End, End]], t: float) -> list[tuple[float, str, bytes]]:
    """Pass on what all send in an event, and end it; return it with who has sent it."""
    passed = []
    for one, other in [*connected, *((b, a) for a, b in connected)]:
        (sender, of), (receiver, to) = one, other
        operations = sender.sent(of)
        if operations:
            receiver.receive(to, operations)
            passed.append((round(t, 9), of, operations))
    for peer in {peer: None for pair in connected for peer, _ in pair}:
        peer.fmu.updateDiscreteStates()
        peer.fmu.enterStepMode()
    return passed


def run(connected: list[tuple[End, End]], steps: int, h: float) -> list[tuple[float, str, bytes]]:
    peers = {peer: None for pair in connected for peer, _ in pair}
    passed = exchanged(connected, 0.0)
    for k in range(steps):
        for peer in peers:
            peer.step(k * h, h)
        for peer in peers:
            peer.fmu.enterEventMode()
        passed += exchanged(connected, (k + 1) * h)
    return passed


# ------------------------------------------------------------------ what the files say


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "terminals", "is_bus"),
    [
        ("can-signals", ["can_bus"], "false"),
        ("canbus", [f"can_n{k}" for k in range(1, 13)], "true"),
    ],
)
def test_files_say_what_the_layered_standard_asks(fmus, name, terminals, is_bus) -> None:
    path = fmus(name)
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        manifest = etree.fromstring(archive.read(MANIFEST))
        listed = etree.fromstring(archive.read(PLACE))
        described = etree.fromstring(archive.read("modelDescription.xml"))
    for root, schema in ((listed, "TerminalsAndIcons"), (described, "ModelDescription")):
        etree.XMLSchema(etree.parse(SCHEMAS / f"fmi3{schema}.xsd")).assertValid(root)
    assert manifest.tag == "fmiLayeredStandardManifest"
    assert manifest.get(f"{MANIFESTS}name") == "org.fmi-standard.fmi-ls-bus"
    assert manifest.get(f"{MANIFESTS}version") == "1.0.0"
    assert manifest.get("isBusSimulationFMU") == is_bus
    simulation = described.find("CoSimulation")
    assert simulation is not None
    assert simulation.get("hasEventMode") == "true"
    variables = {v.get("name"): v for v in described.find("ModelVariables")}  # type: ignore[union-attr]
    buses = [
        one
        for one in listed.iter("Terminal")
        if one.get("terminalKind") == "org.fmi-ls-bus.network-terminal"
    ]
    assert [one.get("name") for one in buses] == terminals
    for one in buses:
        assert one.get("matchingRule") == "org.fmi-ls-bus.transceiver"
        members = {
            m.get("memberName"): m.get("variableName")
            for m in one.iterfind("TerminalMemberVariable")
        }
        assert members.keys() == {"Rx_Data", "Rx_Clock", "Tx_Data", "Tx_Clock"}
        for way, causality in (("Rx", "input"), ("Tx", "output")):
            data, clock = (variables[members[f"{way}_{what}"]] for what in ("Data", "Clock"))
            assert data.get("mimeType") == (
                'application/org.fmi-standard.fmi-ls-bus.can; version="1.0.0"'
            )
            assert data.get("clocks") == clock.get("valueReference")
            assert data.get("causality") == clock.get("causality") == causality
            assert clock.get("intervalVariability") == "triggered"
        notifies = one.findall("Terminal/TerminalMemberVariable[@memberName='BusNotifications']")
        assert len(notifies) == (is_bus == "true")


def test_all_components_on_a_can_bus_are_on_those_of_others_too() -> None:
    """All that exchange operations of `seatrial_kits.can`: they say so by the role of their ports."""
    found = {}
    for name in components().names():
        source = find_source(name, Path.cwd())
        assert isinstance(source, ComponentSource)
        component = source.component_class()(name)
        buses = can_terminals(component)
        if buses:
            found[name] = len(buses)
        operations = [
            p for p in component.ports.values() if "operations" in p.description and p.type is str
        ]
        assert bool(operations) == bool(buses), name
    assert found["canbus"] == 12
    assert {*found} > {"can-signals", "can-traffic", "can-gateway", "nmea2000-node"}


SILENT = """
from seatrial.model.component import Component, Input, Output, terminal


class Silent(Component):
    \"\"\"Has bytes of no bus.\"\"\"

    rx = Input("1", "bytes", type=str, role="bytes")
    tx = Output("1", "bytes", type=str, role="bytes")
    terminals = {"bus": terminal("tx", "rx")}

    def outputs(self, t: float) -> None:
        self.tx = self.rx
"""


def test_a_component_without_a_bus_has_no_event_mode(fmus, write, tmp_path: Path) -> None:
    path = fmus(f"{write('silent.py', SILENT)}:Silent")
    model = fmpy.read_model_description(str(path))
    assert not model.coSimulation.hasEventMode
    with zipfile.ZipFile(path) as archive:
        assert MANIFEST not in archive.namelist()
    with pytest.raises(Exception, match="instantiate"):
        Peer(path, tmp_path)


class Taken(Component):
    """Has a name that its bus terminal needs."""

    rx = Input("1", "operations", type=str, role="can")
    can_bus = Output("1", "whatever")
    tx = Output("1", "operations", type=str, role="can")
    terminals: ClassVar = {"bus": terminal("tx", "rx")}

    def outputs(self, t: float) -> None:
        self.tx, self.can_bus = self.rx, 0.0


def test_a_name_that_the_terminal_needs_is_refused() -> None:
    with pytest.raises(InputError, match=r"the CAN terminal 'bus' is 'can_bus' in FMI 3\.0"):
        can_terminals(Taken())


# ------------------------------------------------------------------ in other importers


@pytest.mark.slow
def test_a_node_and_a_bus_run_on_the_bus_of_another_importer(fmus, dbc, tmp_path: Path) -> None:
    """The first frame, asked for at 0, leaves the node at 10 ms, the bus two steps later.

    Data of 200 bit/s of load at most: nothing waits.
    """
    node = {"database": str(dbc), "sends": "R.Y", "receives": "M.X"}
    bus = Peer(fmus("canbus"), tmp_path / "1", {"nodes": "a b"})
    first = Peer(fmus("can-signals"), tmp_path / "2", node)
    second = Peer(
        fmus("can-signals"),
        tmp_path / "3",
        {"database": str(dbc), "sends": "M.X", "receives": "R.Y"},
    )
    connected = [((first, "can_bus"), (bus, "can_n1")), ((second, "can_bus"), (bus, "can_n2"))]
    for peer, value in ((first, 1234.0), (second, 56.0)):
        peer.fmu.setFloat64([peer.reference["send"]], [value] + 15 * [0.0])
    passed = run(connected, 50, 0.01)
    r, m = transmit(2, struct.pack("<H", 1234)), transmit(1, bytes([56, 0, 0, 0]))
    # Both ask at once, and 1 wins; both frames are over within 10 ms.
    assert [one for one in passed if one[0] < 0.1] == [
        (0.0, "can_bus", configured(250_000)),
        (0.0, "can_bus", configured(250_000)),
        (0.01, "can_bus", r),
        (0.01, "can_bus", m),
        (0.03, "can_n1", m + confirm(2)),
        (0.03, "can_n2", confirm(1) + r),
    ]
    assert bus.count("frames") == [5 + 3]
    assert first.count("frames_received") == [5]
    assert second.count("frames_received") == [3]
    assert first.fmu.getFloat64([first.reference["received"]], 16)[0] == 56.0
    assert second.fmu.getFloat64([second.reference["received"]], 16)[0] == 1234.0
    notifies = bus.reference["can_n1.Configuration.BusNotifications"]
    assert bus.fmu.getBoolean([notifies]) == [True]
    assert bus.messages == first.messages == second.messages == []


def test_nodes_are_connected_without_a_bus(fmus, dbc, tmp_path: Path) -> None:
    ends: list[End] = []
    for k, (sends, receives) in enumerate((("R.Y", "M.X"), ("M.X", "R.Y"))):
        values = {"database": str(dbc), "sends": sends, "receives": receives}
        ends.append((Peer(fmus("can-signals"), tmp_path / str(k), values), "can_bus"))
    run([(ends[0], ends[1])], 100, 0.01)
    assert [end[0].count("frames_sent") for end in ends] == [[5], [10]]
    assert [end[0].count("frames_received") for end in ends] == [[10], [5]]


def test_a_node_says_its_bit_rates_at_the_start(fmus, tmp_path: Path) -> None:
    """Some buses wait for that of each node; our own compares it with its own."""
    for said, expected in (
        ({}, configured(250_000)),
        ({"can_bus.bit_rate": 0.0}, b""),
        (
            {"can_bus.bit_rate": 500e3, "can_bus.data_bit_rate": 2e6},
            configured(500_000) + struct.pack("<IIBI", 0x40, 13, 2, 2_000_000),
        ),
    ):
        node = Peer(fmus("can-signals"), tmp_path / str(len(expected)), said)
        assert node.sent("can_bus") == expected
    reference = node.reference["can_bus.bit_rate"]
    assert node.fmu.getFloat64([node.reference["time"], reference]) == [0.0, 500e3]
    with pytest.raises(Exception, match="fmi3SetFloat64"):
        node.fmu.setFloat64([reference], [250e3])
    assert node.messages == ["can-signals: a bit rate is set before the run"]


def test_what_a_node_says_of_its_bit_rate_reaches_the_bus(fmus, tmp_path: Path) -> None:
    bus = Peer(fmus("canbus"), tmp_path, {"nodes": "a b"})
    bus.receive("can_n2", configured(500_000))
    bus.fmu.updateDiscreteStates()
    bus.fmu.enterStepMode()
    with pytest.raises(Exception, match="fmi3DoStep"):
        bus.step(0.0, 0.01)
    assert "node 'b' has 500000 bit/s, the bus's bit_rate is 250000" in bus.messages[-1]


@pytest.mark.parametrize(("name", "of"), [("can-signals", "can_bus"), ("canbus", "can_n1")])
def test_what_is_no_operation_is_answered_and_the_run_goes_on(fmus, tmp_path, name, of) -> None:
    """CAN XL, which others have, and bytes that are longer than an answer can be."""
    xl = bytes.fromhex("12000000 17000000 23010000 00 00 00 00 00000000 0100 AA")
    for k, (wrong, answered) in enumerate(((xl, xl), (70_000 * b"x", 65_535 * b"x"))):
        peer = Peer(fmus(name), tmp_path / str(k))
        peer.receive(of, wrong)
        peer.fmu.updateDiscreteStates()
        answers = []
        for step in range(3):
            peer.fmu.enterStepMode()
            peer.step(0.1 * step, 0.1)
            peer.fmu.enterEventMode()
            answers.append(peer.sent(of))
        expected = struct.pack("<IIH", 1, 10 + len(answered), len(answered)) + answered
        assert [one for one in answers if one] == [expected]
        assert peer.messages == []


def test_what_changes_in_steps_shows_in_events_only(fmus, dbc, tmp_path: Path) -> None:
    """Continuous are none: counts, and the bytes of our own ports, wait for the event mode."""
    node = {"database": str(dbc), "sends": "R.Y"}
    with_events = Peer(fmus("can-signals"), tmp_path / "1", node)
    without = Peer(fmus("can-signals"), tmp_path / "2", node, events=False)
    with_events.fmu.enterStepMode()
    tx = with_events.reference["tx"]
    assert with_events.step(0.0, 0.01)
    assert not without.step(0.0, 0.01)
    assert (with_events.count("frames_sent"), without.count("frames_sent")) == ([0], [1])
    assert with_events.fmu.getBinary([tx]) == [b""]
    with_events.fmu.enterEventMode()
    assert with_events.count("frames_sent") == [1]
    assert with_events.fmu.getBinary([tx]) == without.fmu.getBinary([tx]) != [b""]
    with_events.fmu.updateDiscreteStates()
    with_events.fmu.enterStepMode()
    assert not with_events.step(0.01, 0.01)  # nothing happens: no event


@pytest.mark.parametrize("name", ["can-signals", "canbus"])
def test_fmpys_own_simulation_takes_it_with_event_mode_and_without(fmus, dbc, name) -> None:
    values = {"database": str(dbc), "sends": "R.Y"} if name == "can-signals" else {}
    output = "frames_sent" if name == "can-signals" else "load"
    results = [
        fmpy.simulate_fmu(
            str(fmus(name)), stop_time=0.5, output_interval=0.01, start_values=values,
            output=[output], use_event_mode=used,
        )
        for used in (False, True)
    ]  # fmt: skip
    last = [row[output].item() for row in (results[0][-1], results[1][-1])]
    assert last[0] == last[1] == (3 if name == "can-signals" else 0.0)


CONTAINER = """
import json, os, sys
from pathlib import Path
import fmpy
from fmu_manipulation_toolbox.assembly import Assembly
folder, spec = Path(sys.argv[1]), json.loads(sys.argv[2])
(folder / "net.json").write_text(json.dumps(spec))
Assembly("net.json", fmu_directory=folder).make_fmu()
result = fmpy.simulate_fmu(str(folder / "net.fmu"), stop_time=1.0, output_interval=0.01)
print("\\n" + json.dumps({name: result[-1][name].item() for name in ("frames", "sent")}), flush=True)
os._exit(0)
"""


@pytest.mark.interop
def test_fmucontainer_routes_what_a_node_sends_to_the_bus(fmus, dbc, tmp_path: Path) -> None:
    """It connects the terminals by their kind and rule; five frames reach the bus in a second.

    Triggered clocks of an FMU that stands before the receiver in its list activate the receiver's
    clock, and its data is not set, in version 2.0: so the bus stands first, and answers to nobody.
    """
    for name in ("canbus", "can-signals"):
        (tmp_path / f"{name}.fmu").write_bytes(fmus(name).read_bytes())
    spec = {
        "name": "net.fmu",
        "fmu": ["canbus.fmu", "can-signals.fmu"],
        "link": [["can-signals.fmu", "can_bus", "canbus.fmu", "can_n1"]],
        "output": [
            ["canbus.fmu", "frames", "frames"],
            ["can-signals.fmu", "frames_sent", "sent"],
        ],
        "start": [
            ["can-signals.fmu", "database", str(dbc)],
            ["can-signals.fmu", "sends", "R.Y"],
        ],
        "step_size": 0.01,
        **{f"auto_{kind}": False for kind in ("input", "output", "link", "parameter")},
    }
    command = [sys.executable, "-c", CONTAINER, str(tmp_path), json.dumps(spec)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    # No other node is there to acknowledge but the one that n2 stands for.
    assert json.loads(done.stdout.splitlines()[-1]) == {"frames": 5, "sent": 5}


# ------------------------------------------------------------------ in our own


@pytest.fixture
def foreign(fmus, tmp_path: Path):
    """Return a function that makes an FMU of ours look as somebody else's to our importer."""

    def make(name: str, *ports: str) -> Path:
        marks = [(f'<port terminal="{port}" />', "") for port in ports]
        return changed(fmus(name), tmp_path / f"foreign-{name}.fmu", *marks, member=PLACE)

    return make


def test_our_importer_takes_the_ports_with_exact_times(fmus) -> None:
    fmu = load_fmu(fmus("canbus"))
    assert (fmu.buses, fmu.notes, fmu.clocks.by_reference) == ([], (), {})
    assert [*fmu.terminals] == [f"n{k}" for k in range(1, 13)]
    assert not any(name.startswith("can_") for name in fmu.variables)


def test_our_bus_serves_nodes_of_others_as_a_bus_of_another(foreign, native_fmu, write) -> None:
    """Two nodes in C, with countdown clocks, and the bus through its clocks: all that was sent came."""
    bus = foreign("canbus", "n1", "n2")
    node = native_fmu("cannode")
    rig = f"""
    step = "1 ms"
    [components]
    a = {{ fmu = "{node}" }}
    b = {{ fmu = "{node}" }}
    can = {{ fmu = "{bus}", set = {{ nodes = "a b" }} }}
    [connections]
    "a.bus" = "can.can_n1"
    "b.bus" = "can.can_n2"
    """
    values = {"a.id": 0x123, "a.frames": 5, "a.value": 0x0807060504030201, "b.frames": 3, "b.id": 7}
    with Simulation(write("rig.toml", rig), engine="fmu", set=values) as simulation:
        simulation.run(0.1)
        names = ("a.confirmed", "b.received", "b.confirmed", "a.received", "can.frames")
        assert [simulation.get(name) for name in names] == [5, 5, 3, 3, 8]
        assert simulation.get("b.last_value") == values["a.value"]


def test_our_node_is_one_of_another_on_our_bus(foreign, fmus, dbc, write) -> None:
    node = foreign("can-signals", "bus")
    rig = f"""
    step = "10 ms"
    [components]
    a = {{ fmu = "{node}", set = {{ database = "{dbc}", sends = "R.Y", receives = "M.X" }} }}
    b = {{ fmu = "can-signals", set = {{ database = "{dbc}", sends = "M.X", receives = "R.Y" }} }}
    can = {{ fmu = "canbus", set = {{ nodes = "a b" }} }}
    [connections]
    "a.can_bus" = "can.n1"
    "b.bus" = "can.n2"
    """
    values = {"a.send.s1": 1234.0, "b.send.s1": 56.0}
    with Simulation(write("rig.toml", rig), engine="fmu", set=values) as simulation:
        simulation.run(1.0)
        state = simulation.save()
        simulation.run(1.2)
        end = [simulation.get(name) for name in ("a.frames_received", "b.frames_received")]
        simulation.restore(state)
        assert simulation.get("a.frames_received") == 10
        simulation.run(1.2)
        assert [simulation.get(n) for n in ("a.frames_received", "b.frames_received")] == end
        assert end == [12, 6]
        assert simulation.get("a.received.s1") == 56.0
        assert simulation.get("b.received.s1") == 1234.0


# ------------------------------------------------------------------ C


EVENTS = """
#define BUSES 1
#define BUS_SCALARS {{0, 1}, {0, 0}}
#define ARE_BUSES 1
#define HELD_REALS 0
#define HELD_REALS_SCALARS {0}
#define HELD_INTEGERS 1
#define HELD_INTEGERS_SCALARS {2, 0}
#define HELD_BOOLEANS 0
#define HELD_BOOLEANS_SCALARS {0}
#define HELD_STRINGS 1
#define HELD_STRINGS_SCALARS {1, 0}
"""


def test_sanitizers_find_nothing_in_events_and_states(tmp_path: Path) -> None:
    """A host in C, which also does what it must not, with a component in C that sends bytes back."""
    for name, content in front_sources().items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "events.h").write_text(EVENTS)
    host = Path(__file__).parent / "slaves" / "bus_host.c"
    flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover", f"-I{tmp_path}"]
    command = ["cc", "-Wall", *flags, str(host), *map(str, tmp_path.glob("*.c"))]
    subprocess.run([*command, "-o", str(tmp_path / "host"), "-lm"], check=True)
    done = subprocess.run([tmp_path / "host"], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
