"""Step sizes, which SSP leaves to annotations of the tools."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lxml import etree

from seatrial.errors import InputError
from seatrial.system.rig import LONGEST_S

from .documents import NAMESPACES, child, children, needed, number, tag, where
from .notes import Notes

OSP = "com.opensimulationplatform"
OMS = "org.openmodelica"


@dataclass(frozen=True)
class StepSizes:
    """Communication steps of the whole system, s, as the annotations say."""

    osp: float | None = None
    oms: float | None = None


def read_steps(experiment: Any | None, system: Any, notes: Notes) -> StepSizes:
    """Return the step sizes that OSP's and OMSimulator's annotations give.

    ``notes`` gets what is met and not used. Raises InputError for a size that is no number
    above 0.
    """
    osp = oms = None
    for holder in (experiment, system):
        for kind, one in _annotations(holder, notes):
            for element in one.iter(etree.Element):
                if kind == OSP and tag(element) == "osp:FixedStepAlgorithm":
                    osp = _positive(element, "baseStepSize")
                elif kind == OMS and tag(element) == "oms:FixedStepMaster":
                    oms = _positive(element, "stepSize")
                elif etree.QName(element).localname in _SOLVERS:
                    name = etree.QName(element).localname
                    notes.pass_over(
                        where(element), f"{name} of the annotation {kind!r} is not used"
                    )
    return StepSizes(osp, oms)


_SOLVERS = {"VariableStepSolver", "VariableStepMaster", "FixedStepSolver", "EccoAlgorithm"}


def read_step_hint(component: Any, notes: Notes) -> float | None:
    """Return a component's own communication step, s, if OSP's annotation gives one."""
    found = None
    for kind, one in _annotations(component, notes):
        for element in one.iter(etree.Element):
            if kind == OSP and tag(element) == "osp:StepSizeHint":
                found = _positive(element, "value")
    return found


def _annotations(holder: Any | None, notes: Notes) -> list[tuple[str, Any]]:
    listed = child(holder, "ssd:Annotations") if holder is not None else None
    found = []
    for one in children(listed) if listed is not None else ():
        kind = needed(one, "type")
        if kind in (OSP, OMS):
            found.append((kind, one))
        else:
            notes.pass_over(where(one), f"annotations of type {kind!r} are not read")
    return found


def _positive(element: Any, name: str) -> float:
    needed(element, name)
    value = number(element, name)
    if value is None or not 0.0 < value <= LONGEST_S:
        raise InputError(
            f"{where(element)}: {name}: must be above 0, at most {LONGEST_S:g}, found {value!r}"
        )
    return value


def write_osp(parent: Any, element: str, attributes: dict[str, str], around: str = "") -> None:
    """Append OSP's annotation with ``element``, inside ``around`` if that is named."""
    holder = _annotation(parent, OSP)
    if around:
        holder = etree.SubElement(holder, f"{{{NAMESPACES['osp']}}}{around}")
    etree.SubElement(holder, f"{{{NAMESPACES['osp']}}}{element}", attributes)


def write_oms(parent: Any, step: float) -> None:
    """Append OMSimulator's annotation: a fixed step of ``step``, s."""
    holder = _annotation(parent, OMS)
    for name in ("Annotations", "SimulationInformation"):
        holder = etree.SubElement(holder, f"{{{NAMESPACES['oms']}}}{name}")
    etree.SubElement(
        holder,
        f"{{{NAMESPACES['oms']}}}FixedStepMaster",
        {
            "description": "oms-ma",
            "stepSize": repr(step),
            "absoluteTolerance": "0.0001",
            "relativeTolerance": "0.0001",
        },
    )


def _annotation(parent: Any, kind: str) -> Any:
    listed = etree.SubElement(parent, f"{{{NAMESPACES['ssd']}}}Annotations")
    return etree.SubElement(listed, f"{{{NAMESPACES['ssc']}}}Annotation", type=kind)
