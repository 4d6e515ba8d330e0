"""FMUs of ``slaves/model.c`` in every version of FMI and interface."""

from __future__ import annotations

import zipfile
from functools import cache
from pathlib import Path

import fmpy

from .native import SLAVES, compiled

_REALS = {
    "k": (0, "parameter", "1"),
    "x": (1, "output", "1"),
    "dx": (2, "local", None),
    "height": (3, "output", "1"),
    "speed": (4, "output", "0"),
    "fall": (5, "local", None),
    "u": (6, "input", "0"),
    "y": (7, "output", None),
    "end": (8, "parameter", "0"),
    "trouble": (9, "parameter", "0"),
}
_OTHERS = [
    ("Integer", "steps", 100, "output", None),
    ("Integer", "relay", 101, "output", None),
    ("Integer", "events", 102, "output", None),
    ("Boolean", "flag", 200, "input", "false"),
    ("Boolean", "not_flag", 201, "output", None),
    ("String", "text", 300, "input", ""),
    ("String", "echo", 301, "output", None),
]
_STATES = {"dx": "x", "fall": "speed", "speed": "height"}


@cache
def build_model_fmu(version: int, folder: Path, interface: str = "model exchange") -> Path:
    """Return the FMU of a version; of FMI 2.0 with both interfaces, ``interface`` for FMI 1.0."""
    name = f"model{version}{'cs' if interface == 'co-simulation' else ''}"
    library = compiled(SLAVES / "model.c", folder / f"{name}.so", f"-DFMI={version}")
    path = folder / f"{name}.fmu"
    platform = fmpy.platform_tuple if version == 3 else fmpy.platform
    describe = {1: _fmi1, 2: _fmi2, 3: _fmi3}[version]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", describe(interface))
        archive.write(library, f"binaries/{platform}/model.so")
    return path


def _fmi1(interface: str) -> str:
    variables = []
    for name, (reference, causality, start) in _REALS.items():
        kind = {"parameter": 'variability="parameter"', "local": ""}.get(
            causality, f'causality="{causality}"'
        )
        value = "" if start is None or causality == "output" else f' start="{start}"'
        variables.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" {kind}>'
            f"<Real{value}/>{_depends(name)}</ScalarVariable>"
        )
    variables.append(
        '<ScalarVariable name="minus_x" valueReference="1" causality="output" '
        'alias="negatedAlias"><Real/><DirectDependency/></ScalarVariable>'
    )
    variables += [
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="discrete"><{kind}{"" if start is None else f" start={start!r}"}/>'
        "</ScalarVariable>"
        for kind, name, reference, causality, start in _OTHERS
    ]
    simulation = (
        "<Implementation><CoSimulation_StandAlone><Capabilities "
        'canHandleVariableCommunicationStepSize="true"/></CoSimulation_StandAlone></Implementation>'
    )
    return (
        '<fmiModelDescription fmiVersion="1.0" modelName="model" modelIdentifier="model" '
        'guid="{model}" numberOfContinuousStates="3" numberOfEventIndicators="1">'
        f"<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"{simulation if interface == 'co-simulation' else ''}</fmiModelDescription>"
    )


def _depends(name: str) -> str:
    if name in ("x", "height", "speed"):
        return "<DirectDependency/>"
    return "<DirectDependency><Name>u</Name></DirectDependency>" if name == "y" else ""


def _fmi2(_interface: str) -> str:
    index = {name: place for place, name in enumerate(_REALS, 1)}
    variables = []
    for name, (reference, causality, start) in _REALS.items():
        of = f' derivative="{index[_STATES[name]]}"' if name in _STATES else ""
        value = "" if start is None else f' start="{start}"'
        fixed = ' variability="fixed"' if causality == "parameter" else ""
        exact = ' initial="exact"' if causality == "output" and start is not None else ""
        variables.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" '
            f'causality="{causality}"{fixed}{exact}><Real{value}{of}/></ScalarVariable>'
        )
    variables += [
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="discrete"><{kind}{"" if start is None else f" start={start!r}"}/>'
        "</ScalarVariable>"
        for kind, name, reference, causality, start in _OTHERS
    ]
    outputs = "".join(
        f'<Unknown index="{index[name]}" dependencies="{index["u"] if name == "y" else ""}"/>'
        for name in ("x", "height", "speed", "y")
    )
    derivatives = "".join(f'<Unknown index="{index[name]}"/>' for name in _STATES)
    return (
        '<fmiModelDescription fmiVersion="2.0" modelName="model" guid="{model}" '
        'numberOfEventIndicators="1">'
        '<ModelExchange modelIdentifier="model" canGetAndSetFMUstate="true"/>'
        '<CoSimulation modelIdentifier="model" canHandleVariableCommunicationStepSize="true"/>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables><ModelStructure>"
        f"<Outputs>{outputs}</Outputs><Derivatives>{derivatives}</Derivatives>"
        "</ModelStructure></fmiModelDescription>"
    )


def _fmi3(_interface: str) -> str:
    variables = []
    for name, (reference, causality, start) in _REALS.items():
        of = f' derivative="{_REALS[_STATES[name]][0]}"' if name in _STATES else ""
        value = "" if start is None else f' start="{start}"'
        fixed = ' variability="fixed"' if causality == "parameter" else ""
        exact = ' initial="exact"' if causality == "output" and start is not None else ""
        variables.append(
            f'<Float64 name="{name}" valueReference="{reference}" causality="{causality}"'
            f"{fixed}{exact}{value}{of}/>"
        )
    for kind, name, reference, causality, start in _OTHERS:
        inside = f'<Start value="{start}"/>' if kind == "String" and start is not None else ""
        value = "" if start is None or kind == "String" else f' start="{start}"'
        variables.append(
            f'<{kind.replace("Integer", "Int32")} name="{name}" valueReference="{reference}" '
            f'causality="{causality}"{value}>{inside}</{kind.replace("Integer", "Int32")}>'
        )
    outputs = "".join(
        f'<Output valueReference="{_REALS[name][0]}" '
        f'dependencies="{_REALS["u"][0] if name == "y" else ""}"/>'
        for name in ("x", "height", "speed", "y")
    )
    derivatives = "".join(
        f'<ContinuousStateDerivative valueReference="{_REALS[name][0]}"/>' for name in _STATES
    )
    return (
        '<fmiModelDescription fmiVersion="3.0" modelName="model" instantiationToken="{model}">'
        '<ModelExchange modelIdentifier="model" canGetAndSetFMUState="true" '
        'needsCompletedIntegratorStep="true"/>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"<ModelStructure>{outputs}{derivatives}</ModelStructure></fmiModelDescription>"
    )
