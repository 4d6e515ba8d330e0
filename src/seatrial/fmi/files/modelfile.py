"""A modelDescription.xml read element by element: an FMU may have very many variables."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fmpy.model_description import ModelDescription, read_model_description
from lxml import etree

from .xmlfile import streamed_xml

_VARIABLES = (
    "ScalarVariable",
    *(f"{sign}Int{bits}" for bits in (8, 16, 32, 64) for sign in ("", "U")),
    *("Float32", "Float64", "Boolean", "String", "Binary", "Enumeration", "Clock"),
)
_UNKNOWNS = (
    "Unknown",
    *("Output", "ContinuousStateDerivative", "ClockedState", "InitialUnknown", "EventIndicator"),
)
_STREAMED = (*_VARIABLES, *_UNKNOWNS)


@dataclass(frozen=True)
class ModelFile:
    """What a model description says besides its variables, which `variables` reads anew."""

    path: Path
    called: str
    """In messages."""
    root: Any
    """The XML element, without variables and model structure."""
    dependencies: dict[int, list[int] | None] = field(default_factory=dict)
    """What outputs depend on; in FMI 2.0 by place in the file, from 1, in FMI 3.0 by reference."""
    derivatives: int = 0
    """Number of derivatives that FMI 2.0 lists, one for each state."""

    def variables(self) -> Iterator[Any]:
        """Yield the XML elements of the variables; their content goes when they are let go.

        Raises InputError as `streamed_xml`.
        """
        for element in streamed_xml(self.path, self.called, _STREAMED, _is_streamed):
            if _is_variable(element) and element.get("name") is not None:
                yield element

    def header(self) -> ModelDescription:
        """Return the model description without variables, as FMPy has it."""
        content = io.BytesIO()
        with zipfile.ZipFile(content, "w") as archive:
            archive.writestr("modelDescription.xml", etree.tostring(self.root, encoding="UTF-8"))
        found = read_model_description(content, validate=False)
        if self.root.get("fmiVersion") == "2.0":
            found.numberOfContinuousStates = self.derivatives
        return found


def read_model(path: Path, called: str) -> ModelFile:
    """Read a model description up to its variables. Raises InputError as `streamed_xml`.

    ValueError for a model structure that does not have numbers.
    """
    derivatives = 0
    dependencies: dict[int, list[int] | None] = {}
    for element in streamed_xml(path, called, _STREAMED, _is_streamed):
        parent = element.getparent()
        if parent is None:
            return ModelFile(path, called, element, dependencies, derivatives)
        if parent.tag == "Outputs" or element.tag == "Output":
            said = element.get("dependencies")
            number = int(element.get("index") or element.get("valueReference") or "")
            dependencies[number] = None if said is None else [int(one) for one in said.split()]
        derivatives += parent.tag == "Derivatives"
    raise AssertionError("the root comes last")


def _is_variable(element: Any) -> bool:
    """Say if an element is a child of the ModelVariables."""
    parent = element.getparent()
    return parent is not None and parent.tag == "ModelVariables"


def _is_streamed(element: Any) -> bool:
    parent = element.getparent()
    return parent is not None and (element.tag in _UNKNOWNS or parent.tag == "ModelVariables")
