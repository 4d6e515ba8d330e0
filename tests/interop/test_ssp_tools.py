"""Findings of `ssp check` on other tools, against the tools."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial_kits.interchange.ssp.tools import FACTS, TOOLS, findings
from tests.kits.interchange.ssp_files import (
    BACK,
    BINDING,
    DAMPER,
    EIGHT,
    HULL,
    MINIMAL,
    STEP,
    THERE,
    Yard,
    description,
    linear,
    nested,
    parameter_set,
    real,
    speed,
    system,
)

from . import ssp_tools


@pytest.fixture(scope="module")
def yard(tmp_path_factory: pytest.TempPathFactory) -> Yard:
    return Yard(tmp_path_factory.mktemp("yard"))


def renamed(prefix: str, text: str = MINIMAL) -> str:
    return text.replace(f"{prefix}:", "q:").replace(f"xmlns:{prefix}", "xmlns:q")


def retyped(kind: str) -> str:
    return MINIMAL.replace('kind="output"><ssc:Real/>', f'kind="output"><ssc:{kind}/>', 1)


def transformed(transformation: str) -> str:
    return MINIMAL.replace(THERE, THERE[:-2] + f">{transformation}</ssd:Connection>")


def with_compass(connector: str, more: str = "", hull: str = "") -> str:
    """Add a compass with a connector; ``hull`` has more connectors, ``more`` connections."""
    added = (
        '<ssd:Component name="compass" source="resources/Compass.fmu"><ssd:Connectors>'
        f"{connector}</ssd:Connectors></ssd:Component></ssd:Elements>"
    )
    ssd = MINIMAL.replace("</ssd:Elements>", added)
    ssd = ssd.replace("</ssd:Connections>", f"{more}</ssd:Connections>")
    return ssd.replace('<ssd:Connector name="force" kind="input">', hull + '<ssd:Connector name="force" kind="input">', 1)  # fmt: skip


LOOSE = '<ssd:Connector name="angle" kind="input"><ssc:Real/></ssd:Connector>'
OUT = '<ssd:Connectors><ssd:Connector name="out" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>'
TO_OUT = '<ssd:Connection startElement="hull" startConnector="v" endConnector="out"/>'
PACKED = '<ssd:Component name="more" type="application/x-ssp-package" source="resources/more.ssp"/>'
BACKWARDS = (
    '<ssd:Connection startElement="damper" startConnector="v" endElement="hull" endConnector="v"/>'
)
MAPPED = 'source="resources/hull.ssv"><ssd:ParameterMapping source="resources/x.ssm"/></ssd:ParameterBinding>'

VARIANTS = {
    "minimal": MINIMAL,
    "version 1.1": MINIMAL.replace('"Minimal" version="1.0"', '"Minimal" version="1.1"'),
    "version 2.0": MINIMAL.replace('"Minimal" version="1.0"', '"Minimal" version="2.0"'),
    "prefix of ssd": renamed("ssd"),
    "prefix of ssc": renamed("ssc"),
    "prefix of osp": renamed("osp"),
    "nested": nested(),
    "equal paths": nested().replace('"in"', '"damper.v"'),
    "connector of the system": description(
        system(HULL + DAMPER, THERE + BACK + TO_OUT, before=OUT)
    ),
    "package": MINIMAL.replace("</ssd:Elements>", f"{PACKED}</ssd:Elements>"),
    "transformation": transformed(linear(2.0, 0.5)),
    "no type": MINIMAL.replace("<ssc:Real/>", ""),
    "one type missing": MINIMAL.replace("<ssc:Real/>", "", 1),
    "enumeration": retyped('Enumeration name="x"'),
    "binary": retyped("Binary"),
    "unequal types": retyped("Integer"),
    "text": with_compass('<ssd:Connector name="text" kind="output"><ssc:String/></ssd:Connector>'),
    "count": with_compass(
        '<ssd:Connector name="count" kind="output"><ssc:Integer/></ssd:Connector>'
    ),
    "not declared": MINIMAL.replace(
        '<ssd:Connector name="force" kind="output"><ssc:Real/></ssd:Connector>', ""
    ),
    "no step": MINIMAL.replace(STEP, ""),
    "loose input": MINIMAL.replace(
        '<ssd:Connector name="force" kind="input">',
        f'{LOOSE}<ssd:Connector name="force" kind="input">',
    ),
    "nonsense": MINIMAL.replace("</ssd:Elements>", "</ssd:Elements><ssd:Nonsense/>"),
    "hyphen": MINIMAL.replace('"damper"', '"the-damper"'),
    "geometry": MINIMAL.replace(
        "</ssd:Connections>",
        '</ssd:Connections><ssd:SystemGeometry x1="0" y1="0" x2="1" y2="1"/>',
    ),
}


@pytest.mark.parametrize("tool", ssp_tools.TOOLS)
@pytest.mark.parametrize("variant", VARIANTS)
def test_what_is_said_to_be_rejected_is(
    variant: str, tool: str, yard: Yard, tmp_path: Path
) -> None:
    members = {"resources/more.ssp": yard.package(tmp_path / "more.ssp").read_bytes()}
    path = yard.package(tmp_path / "x.ssp", VARIANTS[variant], members)
    said = any(one.rejects for one in findings(path) if one.tool == tool)
    done = ssp_tools.started(tool, path, steps=3, watch=["hull.v"])
    assert (done.returncode != 0) == said, done.stderr[-2000:]


TWO = BINDING.replace("</ssd:ParameterBindings>", '<ssd:ParameterBinding source="resources/two.ssv"/></ssd:ParameterBindings>')  # fmt: skip
MEMBERS: dict[str, str | bytes] = {
    "resources/two.ssv": parameter_set(real("mass", 4.0)).replace('name="hull"', 'name="two"', 1),
    "resources/x.ssm": "<x/>",
}
GRAMS = parameter_set(
    real("mass", 8000.0, "g"),
    after='<ssv:Units><ssc:Unit name="g"><ssc:BaseUnit kg="1" factor="0.001"/></ssc:Unit></ssv:Units>',
)
OF_SYSTEM = description(
    system(
        HULL.replace(BINDING, "") + DAMPER,
        THERE + BACK,
        before=BINDING.replace("source=", 'prefix="hull." source='),
    )
)

# (what is met, description, its own values, tool, what it says, the hull's speed then)
DIFFERENCES = [
    ("values", MINIMAL, {}, "libcosim", None, speed(8.0)),
    ("values", MINIMAL, {}, "fmpy", "ignores parameter bindings", speed(2.0)),
    ("values", MINIMAL, {}, "ecos", "only if its caller names it", speed(2.0)),
    ("values of a system", OF_SYSTEM, {}, "libcosim", "bindings of systems", speed(2.0)),
    ("values of a system", OF_SYSTEM, {}, "fmpy", "bindings of systems", speed(2.0)),
    ("two sets", MINIMAL.replace(BINDING, TWO), MEMBERS, "libcosim", "the first", speed(8.0)),
    ("prefix", MINIMAL.replace('source="resources/hull.ssv"', 'source="resources/hull.ssv" prefix="x."'), {}, "libcosim", "ignores the prefix", speed(8.0)),
    ("grams", MINIMAL, {"resources/hull.ssv": GRAMS}, "libcosim", "ignores units", speed(8000.0)),
    ("mapping", MINIMAL.replace('source="resources/hull.ssv"/>', MAPPED), MEMBERS, "libcosim", "ignores parameter mappings", speed(8.0)),
    ("factor", transformed(linear(2.0, 0.0)), {}, "libcosim", None, speed(8.0, 1.0)),
    ("factor", transformed(linear(2.0, 0.0)), {}, "fmpy", "ignores transformations", speed(2.0)),
    ("factor", transformed(linear(2.0, 0.0)), {}, "ecos", None, speed(2.0, 1.0)),
    ("no factor", transformed(linear(None, 0.5)), {}, "ecos", "missing factor as 0", 1.0 - 2.0 * 0.5 * 0.5 / 2.0),
    ("backwards", MINIMAL.replace(THERE, BACKWARDS), {}, "ecos", "starts at an input", 1.0),
]  # fmt: skip


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("ssd", "members", "tool", "said", "expected"),
    [case[1:] for case in DIFFERENCES],
    ids=[f"{case[0]}, {case[3]}" for case in DIFFERENCES],
)
def test_what_is_said_to_differ_does(
    ssd: str, members: dict[str, str | bytes], tool: str, said: str | None, expected: float,
    yard: Yard, tmp_path: Path,
) -> None:  # fmt: skip
    path = yard.package(tmp_path / "x.ssp", ssd, members)
    texts = [one.text for one in findings(path) if one.tool == tool and not one.rejects]
    assert said is None or any(said in text for text in texts)
    rows = ssp_tools.run(tool, path, steps=200, watch=["hull.v"])
    assert rows[-1][0] == pytest.approx(expected, abs=6e-3)  # of two steps of delay


def test_ecos_applies_the_parameter_set_that_is_named(yard: Yard, tmp_path: Path) -> None:
    path = yard.package(tmp_path / "x.ssp")
    rows = ssp_tools.run("ecos", path, steps=200, watch=["hull.v"], parameters="hull")
    assert rows[-1][0] == pytest.approx(speed(8.0), abs=1e-3)


@pytest.mark.parametrize("tool", ssp_tools.TOOLS)
def test_no_tool_converts_units(tool: str, yard: Yard, tmp_path: Path) -> None:
    connection = '<ssd:Connection startElement="compass" startConnector="angle" endElement="hull" endConnector="angle"/>'
    angle = '<ssd:Connector name="{}" kind="{}"><ssc:Real unit="{}"/></ssd:Connector>'
    hull = angle.format("turned", "output", "rad") + angle.format("angle", "input", "rad")
    ssd = with_compass(angle.format("angle", "output", "deg"), connection, hull)
    path = yard.package(tmp_path / "x.ssp", ssd)
    assert any("converts no units" in one.text for one in findings(path) if one.tool == tool)
    rows = ssp_tools.run(tool, path, steps=5, watch=["hull.turned"])
    assert rows[-1][0] == 90.0


def test_every_fact_is_of_a_known_tool() -> None:
    named = {tool for fact in FACTS for tool in (*fact.rejected, *fact.changed)}
    assert named == set(TOOLS)


def test_half_a_transformation_and_names_are_named_for_omsimulator(
    yard: Yard, tmp_path: Path
) -> None:
    ssd = transformed(linear(2.0)).replace('"damper"', '"the-damper"')
    path = yard.package(tmp_path / "x.ssp", ssd, {"resources/hull.ssv": EIGHT})
    texts = [one.text for one in findings(path) if one.tool == "omsimulator" and one.rejects]
    assert len(texts) == 2
