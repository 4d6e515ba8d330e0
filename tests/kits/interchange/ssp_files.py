"""SSP packages written by hand: a hull with a damper, and variations of it."""

from __future__ import annotations

import zipfile
from pathlib import Path

from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.system import System
from seatrial.trial.files.trial import load_trial

BOATS = '''
"""Two components with a closed form."""
from seatrial.model.component import Component, Input, Output, Parameter


class Hull(Component):
    """m v' = force by explicit Euler, from 1 m/s."""

    mass = Parameter(2.0, "kg", "mass")
    offset = Parameter((0.0, 0.0), "m", "published as it is", axes="xy")
    label = Parameter("none", "1", "text")
    force = Input("N", "force")
    angle = Input("rad", "unused angle")
    on = Input("1", "unused switch", type=bool)
    count = Input("1", "unused count", type=int)
    v = Output("m/s", "speed")
    turned = Output("rad", "the angle")
    feedthrough = {"turned": ("angle",)}

    def start(self, t):
        self.speed = 1.0

    def step(self, t, h):
        self.speed += h * self.force / self.mass

    def outputs(self, t):
        self.v, self.turned = self.speed, self.angle


class Damper(Component):
    """force = -damping v."""

    damping = Parameter(0.5, "N.s/m", "damping")
    v = Input("m/s", "speed")
    force = Output("N", "force")
    feedthrough = {"force": ("v",)}

    def outputs(self, t):
        self.force = -self.damping * self.v


class Compass(Component):
    """An angle in degrees, a count and a text."""

    angle = Output("deg", "angle")
    count = Output("1", "count", type=int)
    text = Output("1", "text", type=str)

    def outputs(self, t):
        self.angle, self.count, self.text = 90.0, 3, "north"
'''

NAMESPACES = """xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations\""""

STEP = """<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">
<osp:Algorithm><osp:FixedStepAlgorithm baseStepSize="0.01"/></osp:Algorithm>
</ssc:Annotation></ssd:Annotations>"""

BINDING = """<ssd:ParameterBindings><ssd:ParameterBinding
type="application/x-ssp-parameter-set" source="resources/hull.ssv"/></ssd:ParameterBindings>"""

HULL = f"""<ssd:Component name="hull" type="application/x-fmu-sharedlibrary" source="resources/Hull.fmu">
<ssd:Connectors>
<ssd:Connector name="force" kind="input"><ssc:Real/></ssd:Connector>
<ssd:Connector name="v" kind="output"><ssc:Real/></ssd:Connector>
</ssd:Connectors>
{BINDING}
</ssd:Component>"""

DAMPER = """<ssd:Component name="damper" source="resources/Damper.fmu"><ssd:Connectors>
<ssd:Connector name="v" kind="input"><ssc:Real/></ssd:Connector>
<ssd:Connector name="force" kind="output"><ssc:Real/></ssd:Connector>
</ssd:Connectors></ssd:Component>"""

THERE = """<ssd:Connection startElement="hull" startConnector="v" endElement="damper" endConnector="v"/>"""
BACK = """<ssd:Connection startElement="damper" startConnector="force" endElement="hull" endConnector="force"/>"""


def system(elements: str, connections: str = "", more: str = "", before: str = "") -> str:
    """Return an ``ssd:System`` called root."""
    joined = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    return f"""<ssd:System name="root">{before}<ssd:Elements>
{elements}
</ssd:Elements>{joined}{more}</ssd:System>"""


def description(top: str, *, version: str = "1.0", after: str = "", stop: str = "2.0") -> str:
    """Return a whole description of ``top``, which runs for ``stop`` s in steps of 10 ms."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription {NAMESPACES} name="Minimal" version="{version}">
{top}{after}
<ssd:DefaultExperiment startTime="0.0" stopTime="{stop}">{STEP}</ssd:DefaultExperiment>
</ssd:SystemStructureDescription>"""


SUB = """<ssd:System name="sub"><ssd:Connectors>
<ssd:Connector name="in" kind="input"><ssc:Real/></ssd:Connector>
<ssd:Connector name="out" kind="output"><ssc:Real/></ssd:Connector>
</ssd:Connectors>{bindings}<ssd:Elements>{elements}</ssd:Elements><ssd:Connections>
<ssd:Connection startConnector="in" endElement="damper" endConnector="v">{inner}</ssd:Connection>
<ssd:Connection startElement="damper" startConnector="force" endConnector="out"/>
</ssd:Connections></ssd:System>"""
"""A damper in a system of its own."""

TO_SUB = """<ssd:Connection startElement="hull" startConnector="v" endElement="sub" endConnector="in">{outer}</ssd:Connection>
<ssd:Connection startElement="sub" startConnector="out" endElement="hull" endConnector="force"/>"""


def nested(
    *, inner: str = "", outer: str = "", bindings: str = "", before: str = "", hull: str = HULL
) -> str:
    """Return the minimal system with its damper in a system, and things in between."""
    sub = SUB.format(elements=DAMPER, inner=inner, bindings=bindings)
    return description(system(sub + hull, TO_SUB.format(outer=outer), before=before))


def linear(factor: float | None = None, offset: float | None = None) -> str:
    """Return a linear transformation."""
    pieces = [f'{k}="{v}"' for k, v in (("factor", factor), ("offset", offset)) if v is not None]
    return f"<ssc:LinearTransformation {' '.join(pieces)}/>"


def bound(parameters: str, attributes: str = "", after: str = "") -> str:
    """Return parameter bindings with one set, inline."""
    return f"""<ssd:ParameterBindings><ssd:ParameterBinding {attributes}><ssd:ParameterValues>
{parameter_set(parameters, after=after)}</ssd:ParameterValues></ssd:ParameterBinding>
</ssd:ParameterBindings>"""


MINIMAL = description(system(HULL + DAMPER, THERE + BACK))


def parameter_set(parameters: str, *, version: str = "1.0", after: str = "") -> str:
    """Return a parameter set with ``parameters``."""
    return f"""<ssv:ParameterSet {NAMESPACES} name="hull" version="{version}">
<ssv:Parameters>{parameters}</ssv:Parameters>{after}</ssv:ParameterSet>"""


def real(name: str, value: float | str, unit: str = "") -> str:
    """Return a Real parameter."""
    pieces = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value}"{pieces}/></ssv:Parameter>'


EIGHT = parameter_set(real("mass", 8.0))
"""The hull's mass, kg."""


class Yard:
    """Builds the components' FMUs once and writes packages with them."""

    def __init__(self, folder: Path) -> None:
        (folder / "boats.py").write_text(BOATS, "utf-8")
        self.fmus = {}
        for name in ("Hull", "Damper", "Compass"):
            source = find_source(f"boats.py:{name}", folder)
            assert isinstance(source, ComponentSource)
            self.fmus[name] = build_fmu(source, folder / f"{name}.fmu").read_bytes()

    def package(
        self, path: Path, ssd: str = MINIMAL, members: dict[str, str | bytes] | None = None
    ) -> Path:
        """Write a package: the FMUs, ``resources/hull.ssv`` with a mass of 8 kg, ``members``."""
        files: dict[str, str | bytes] = {"SystemStructure.ssd": ssd, "resources/hull.ssv": EIGHT}
        files |= {f"resources/{name}.fmu": data for name, data in self.fmus.items()}
        files |= members or {}
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in files.items():
                archive.writestr(name, data)
        return path


def speed(mass: float, gain: float = 0.5, seconds: float = 2.0, h: float = 0.01) -> float:
    """Return the hull's speed by Euler without delay, from 1 m/s: (1 - h gain / m)^n."""
    return (1.0 - h * gain / mass) ** round(seconds / h)


def run(path: Path, **changes: str) -> dict[str, float]:
    """Run a package as a trial and return its last signals."""
    trial = load_trial(str(path), changes=changes, origin="test")
    system = assemble(trial.rig)
    try:
        master = Master(system, trial.start_ns, trial.stop_ns)
        master.initialise()
        for _ in range(trial.steps):
            master.step()
        master.terminate()
        names = [".".join(name) for name in master.names]
        return dict(zip(names, master.signals, strict=True))
    finally:
        system.free()


def rows(system: System, steps: int) -> list[dict[str, object]]:
    """Return every output after each step."""
    try:
        master = Master(system)
        master.initialise()
        found = []
        for _ in range(steps):
            master.step()
            names = [".".join(name) for name in master.names]
            found.append(dict(zip(names, master.signals, strict=True)))
        return found
    finally:
        system.free()
