"""A system structure of OSP-IS with small FMUs in C: every kind of function and connection."""

from __future__ import annotations

from pathlib import Path

from tests.fmi.native import build_native_fmu

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
"""

GROUPS = """<?xml version="1.0" encoding="UTF-8"?>
<OspModelDescription xmlns="https://open-simulation-platform.com/OspModelDescription/1.0.1" version="1.0">
    <VariableGroups>
        <Generic name="pair in"><Variable ref="q[1]"/><Variable ref="q[2]"/></Generic>
        <Generic name="pair out"><Variable ref="p[1]"/><Variable ref="p[2]"/></Generic>
        <Generic name="gives">
            <Generic name="gives ints"><Variable ref="j"/></Generic>
            <Generic name="gives texts"><Variable ref="r"/><Variable ref="c"/></Generic>
        </Generic>
        <Generic name="takes">
            <Generic name="takes ints"><Variable ref="i"/></Generic>
            <Generic name="takes texts"><Variable ref="s"/><Variable ref="b"/></Generic>
        </Generic>
    </VariableGroups>
</OspModelDescription>
"""

SYSTEM = (
    HEAD
    + """    <StartTime>0.0</StartTime>
    <EndTime>3.0</EndTime>
    <BaseStepSize>0.1</BaseStepSize>
    <Algorithm>fixedStep</Algorithm>
    <Simulators>
        <Simulator name="slave uno" source="fmi2.fmu">
            <InitialValues>
                <InitialValue variable="k"><Real value="0.3"/></InitialValue>
                <InitialValue variable="q[1]"><Real value="0.25"/></InitialValue>
                <InitialValue variable="q[2]"><Real value="-4"/></InitialValue>
                <InitialValue variable="i"><Integer value="7"/></InitialValue>
                <InitialValue variable="b"><Boolean value="true"/></InitialValue>
                <InitialValue variable="s"><String value="ahoy"/></InitialValue>
            </InitialValues>
        </Simulator>
        <Simulator name="two" source="fmi2.fmu">
            <InitialValues>
                <InitialValue variable="k"><Real value="0.7"/></InitialValue>
                <InitialValue variable="gain"><Real value="-1.5"/></InitialValue>
            </InitialValues>
        </Simulator>
        <Simulator name="three" source="fmi2.fmu"/>
        <Simulator name="slow" source="fmi2.fmu" stepSize="0.3"/>
        <Simulator name="last" source="fmi2.fmu" stepSize="0.65"/>
    </Simulators>
    <Functions>
        <LinearTransformation name="scale" factor="2.5" offset="-0.1"/>
        <LinearTransformation name="same"/>
        <Sum name="total" inputCount="3"/>
        <VectorSum name="forces" inputCount="2" dimension="2"/>
    </Functions>
    <Connections>
        <SignalConnection>
            <Variable simulator="slave uno" name="x"/><Signal function="scale" name="in"/>
        </SignalConnection>
        <SignalConnection>
            <Signal function="scale" name="out"/><Variable simulator="two" name="u"/>
        </SignalConnection>
        <SignalConnection>
            <Variable simulator="slave uno" name="x"/><Signal function="total" name="in[0]"/>
        </SignalConnection>
        <SignalConnection>
            <Variable simulator="two" name="x"/><Signal function="total" name="in[1]"/>
        </SignalConnection>
        <SignalConnection>
            <Variable simulator="two" name="y"/><Signal function="total" name="in[2]"/>
        </SignalConnection>
        <SignalConnection>
            <Signal function="total" name="out"/><Variable simulator="three" name="u"/>
        </SignalConnection>
        <VariableConnection>
            <Variable simulator="two" name="q[2]"/><Variable simulator="slave uno" name="x"/>
        </VariableConnection>
        <VariableConnection>
            <Variable simulator="two" name="y"/><Variable simulator="two" name="q[1]"/>
        </VariableConnection>
        <SignalGroupConnection>
            <SignalGroup function="forces" name="in[0]"/>
            <VariableGroup simulator="slave uno" name="pair out"/>
        </SignalGroupConnection>
        <SignalGroupConnection>
            <VariableGroup simulator="two" name="pair out"/>
            <SignalGroup function="forces" name="in[1]"/>
        </SignalGroupConnection>
        <SignalGroupConnection>
            <VariableGroup simulator="slow" name="pair in"/>
            <SignalGroup function="forces" name="out"/>
        </SignalGroupConnection>
        <VariableGroupConnection>
            <VariableGroup simulator="slave uno" name="gives"/>
            <VariableGroup simulator="slow" name="takes"/>
        </VariableGroupConnection>
        <VariableGroupConnection>
            <VariableGroup simulator="last" name="pair in"/>
            <VariableGroup simulator="slow" name="pair out"/>
        </VariableGroupConnection>
        <VariableConnection>
            <Variable simulator="three" name="y"/><Variable simulator="slow" name="u"/>
        </VariableConnection>
        <SignalConnection>
            <Variable simulator="slow" name="y"/><Signal function="same" name="in"/>
        </SignalConnection>
        <SignalConnection>
            <Variable simulator="last" name="u"/><Signal function="same" name="out"/>
        </SignalConnection>
    </Connections>
</OspSystemStructure>
"""
)


def write_osp(folder: Path, *changes: tuple[str, str]) -> Path:
    """Write the system to ``folder``, with texts in it replaced, and the files that it names."""
    text = SYSTEM
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    if not (folder / "fmi2.fmu").is_file():
        build_native_fmu("fmi2", folder)
    (folder / "fmi2_OspModelDescription.xml").write_text(GROUPS, "utf-8")
    path = folder / "OspSystemStructure.xml"
    path.write_text(text, "utf-8")
    return path
