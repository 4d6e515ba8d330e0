"""Findings of `ssp check` on FMUContainer, against it: containers made and run."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial_kits.interchange.ssp.tools import findings
from tests.kits.interchange.ssp_natives import (
    bound,
    build,
    component,
    connection,
    connector,
    connectors,
    elements,
    entry,
    linear,
    mapping,
    package,
    ssd,
    table,
    value,
    values,
)

from . import ssp_tools

U, X, Y = connector("u", "input"), connector("x", "output"), connector("y", "output")
OUT = connectors(connector("out", "output"))
TWO = component("a", U, X, Y), component("b", U, X, Y)
THERE = connection("a/x", "b/u")
SHOWN = connection("b/y", "out")
FLAT = OUT + elements(*TWO, connections=THERE + SHOWN)
DECAYED = 1.9215788783046468
"""2 exp(-0.04): b has a's state of the step before."""
SUB = f"""<ssd:System name="s">{connectors(connector("in", "input"), connector("out", "output"))}
{elements(TWO[1], connections=connection("in", "b/u") + SHOWN)}</ssd:System>"""
REFERENCE = f'<ssd:SignalDictionaryReference name="r" dictionary="d">{connectors(connector("s", "inout"))}</ssd:SignalDictionaryReference>'


def edited(old: str, new: str) -> str:
    assert old in FLAT
    return FLAT.replace(old, new)


TAKEN = {
    "flat": (FLAT, None, DECAYED),
    "nested": (OUT + elements(TWO[0], SUB, connections=connection("a/x", "s/in") + connection("s/out", "out")), None, DECAYED),
    "backwards": (edited(THERE, connection("b/u", "a/x")), None, DECAYED),
    "no types": (edited("<ssc:Real/>", ""), None, DECAYED),
    "not declared": (OUT + elements(component("a"), component("b"), connections=THERE + SHOWN), None, DECAYED),
    "values": (edited("</ssd:Component>", bound(values(value("k", "0"))) + "</ssd:Component>"), "ignores parameter bindings: FMUs", DECAYED),
    "values of the system": (bound(values(value("a.k", "0"))) + FLAT, "ignores parameter bindings of systems", DECAYED),
    "mapping": (bound(values(value("k", "0")), mapped=mapping(entry("k", "a.k"))) + FLAT, "ignores parameter mappings", DECAYED),
    "factor": (edited(THERE, connection("a/x", "b/u", linear(3.0, 1.0))), "ignores transformations", DECAYED),
    "units": (OUT + elements(component("a", connector("x", "output", unit="m")), component("b", connector("u", "input", unit="cm"), Y), connections=THERE + SHOWN), "converts no units", DECAYED),
    "no outputs": (elements(*TWO, connections=THERE), "shows nothing but what output connectors", None),
}  # fmt: skip
REJECTED = {
    "between the system's own": (connectors(connector("in", "input"), connector("out", "output")) + elements(TWO[0], connections=connection("in", "out")), "needs an element in every connection"),
    "an empty element": (edited('endConnector="out"', 'endElement="" endConnector="out"'), "no empty startElement"),
    "backwards to the system": (edited(SHOWN, connection("out", "b/y")), "at the start of a connection to the system"),
    "a dictionary": (OUT + elements(*TWO, REFERENCE, connections=connection("a/x", "r/s")), "no signal dictionaries"),
    "no source": (OUT + elements(*TWO, '<ssd:Component name="p"/>'), "needs a source"),
    "a package": (OUT + elements(*TWO, '<ssd:Component name="p" type="application/x-ssp-package" source="resources/i.ssp"/>'), "no packages in packages"),
    "a calculated parameter": (elements(component("a", connector("y", "calculatedParameter"), fmu="calc"), component("b", connector("k", "parameter")), connections=connection("a/y", "b/k")), "no calculated parameters"),
    "an element": (elements(component("a", X), component("b", fmu="three"), connections=connection("a/x", "b/in_Float64", more='endIndices="1"')), "no elements of arrays"),
}  # fmt: skip


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return build(tmp_path_factory.mktemp("slaves")) | {"resources/i.ssp": b"not read"}


@pytest.mark.parametrize("case", TAKEN)
@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_what_it_takes_runs_as_is_said(
    case: str, version: str, fmus: dict[str, bytes], tmp_path: Path
) -> None:
    inside, said, expected = TAKEN[case]
    path = package(tmp_path / "x.ssp", ssd(inside, version=version), fmus)
    mine = [one for one in findings(path) if one.tool == "fmucontainer"]
    assert not any(one.rejects for one in mine)
    assert said is None or any(said in one.text for one in mine)
    watch = ["out"] if expected is not None else []
    rows = ssp_tools.run("fmucontainer", path, steps=5, watch=watch)
    assert expected is None or rows[-1][0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("case", REJECTED)
def test_what_it_is_said_to_reject_it_does(
    case: str, fmus: dict[str, bytes], tmp_path: Path
) -> None:
    inside, said = REJECTED[case]
    path = package(tmp_path / "x.ssp", ssd(inside), fmus)
    mine = [one for one in findings(path) if one.tool == "fmucontainer"]
    assert any(said in one.text for one in mine if one.rejects)
    assert ssp_tools.started("fmucontainer", path, steps=1, watch=[]).returncode != 0


def test_it_ignores_tables(fmus: dict[str, bytes], tmp_path: Path) -> None:
    n = connector("out", "output", "Integer")
    ends = connector("j", "output", "Integer"), connector("i", "input", "Integer")
    zero = connection("a/j", "b/i", table("Integer", ("0", "5")))
    listed = component("a", ends[0]), component("b", *ends)
    inside = connectors(n) + elements(*listed, connections=zero + connection("b/j", "out"))
    path = package(tmp_path / "x.ssp", ssd(inside), fmus)
    texts = [one.text for one in findings(path) if one.tool == "fmucontainer"]
    assert any("ignores transformations" in text for text in texts)
    assert ssp_tools.run("fmucontainer", path, steps=5, watch=["out"])[-1] == [0.0]
