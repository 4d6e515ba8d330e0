"""Assembled rigs as system structures of OSP-IS, in a folder with their FMUs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.building.export import fmu_bytes
from seatrial.fmi.cache import write_named
from seatrial.fmi.components.source import find_source
from seatrial.fmi.files.osp import osp_file, osp_xml
from seatrial.fmi.loading.load import load_fmu
from seatrial.model.component import seconds
from seatrial.system.packages import OSP_FILE
from seatrial.system.part import Part
from seatrial.system.system import Connection, System

from ..ssp.describing import Experiment, as_xml
from ..ssp.layout import End, Level, flat, unused
from ..ssp.parameters import type_name, written
from ..ssp.shapes import local_outputs
from ..ssp.writing import refuse_made, unsaid
from .ecco import bonds_by_input, write_settings
from .structure import NAMESPACE


def write_osp(system: System, experiment: Experiment, folder: Path) -> list[str]:
    """Write ``system`` to ``folder`` for libcosim; return what its user must know.

    There are the FMU of each component, its variable groups, and the OspSystemStructure.xml.
    The same input gives the same bytes. Raises InputError for what libcosim cannot take;
    nothing is written then.
    """
    tuned = system.tuned
    top = flat(system, [one for one in system.connections if one.target not in tuned])
    notes: list[str] = []
    files: dict[str, bytes] = {}
    for name, part in top.parts():
        if not part.is_sum:
            _add_fmu(files, name, part, system, notes)
    files[OSP_FILE] = as_xml(_Describer(system, top, notes).document(experiment))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot write {folder}: {error.strerror}") from None
    for name, content in files.items():  # the structure last: it names the others
        write_named(folder / name, content)
    return [*notes, *unsaid(system, ("plain-jacobi", "ecco"))]


def _add_fmu(
    files: dict[str, bytes], name: str, part: Part, system: System, notes: list[str]
) -> None:
    """Add the FMU of a component to the files by name, and its groups if it has any."""
    source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
    groups, model = None, ""
    if isinstance(source, Path):
        files[f"{name}.fmu"] = source.read_bytes()
        description = load_fmu(source).description
        if description.fmiMajorVersion == 3:
            notes.append(f"{part.name}: {source.name} is of FMI 3.0, which libcosim does not read")
        model = description.modelName or ""
        beside = osp_file(source.parent, model)
        if Path(model).name == model and beside.is_file():
            groups = beside.read_bytes()
    else:
        values = {variable: given.value for variable, given in part.given.items()}
        files[f"{name}.fmu"] = fmu_bytes(source, values)
        model, instance = source.name, part.instance
        groups = osp_xml(instance.terminals, instance.variables) if instance.terminals else None
    if groups is not None and files.setdefault(osp_file(Path(), model).name, groups) != groups:
        notes.append(f"{part.name}: another FMU is called {model} too, and has other groups")


class _Describer:
    """Describes the one system of all components. Raises InputError for what OSP-IS cannot say."""

    def __init__(self, system: System, top: Level, notes: list[str]) -> None:
        self._system, self._top = system, top
        self._made: dict[End, tuple[End, Connection]] = {}
        """Connections by their targets."""
        for (source, target), connection in top.connections.items():
            assert connection is not None
            self._refuse(connection)
            self._made[target] = source, connection
        self._taken = set(top.elements)
        self._bonds = bonds_by_input(system, notes)

    def document(self, experiment: Experiment) -> Any:
        """Return the whole description."""
        default: Any = {None: NAMESPACE}
        root = etree.Element(
            f"{{{NAMESPACE}}}OspSystemStructure", {"version": "0.1"}, nsmap=default
        )
        step, file = seconds(self._system.rig.step_ns), self._system.rig.file
        for name, text in (
            ("StartTime", repr(experiment.start)),
            ("EndTime", repr(experiment.stop)),
            ("BaseStepSize", repr(step)),
            ("Algorithm", "ecco" if file.algorithm == "ecco" else "fixedStep"),
        ):
            _add(root, name).text = text
        simulators = _add(root, "Simulators")
        for name, part in self._top.parts():
            if not part.is_sum:
                self._add_simulator(simulators, name, part)
        functions, connections = _add(root, "Functions"), _add(root, "Connections")
        for target, (source, connection) in self._made.items():
            if self._part(source).is_sum:
                self._add_sum(functions, connections, source, target)
            elif not self._part(target).is_sum:
                self._add_connection(functions, connections, source, target, connection)
        # The schema wants transformations before sums, and no element empty.
        functions[:] = sorted(functions, key=lambda one: etree.QName(one).localname)
        for element in (functions, connections):
            if not len(element):
                root.remove(element)
        if file.algorithm == "ecco":
            write_settings(root, self._system)
        return root

    def _part(self, end: End) -> Part:
        part = self._top.elements[end[0]]
        assert isinstance(part, Part)
        return part

    def _refuse(self, connection: Connection) -> None:
        refuse_made(self._system, connection)
        source_part = self._system.parts[connection.source[0]]
        if connection.source[1] in local_outputs(self._system, source_part):
            raise InputError(
                f"{'.'.join(connection.source)} is a local variable, from which OSP-IS has no "
                "connections"
            )
        source, target = (
            self._system.parts[name].instance.variables[port]
            for name, port in (connection.source, connection.target)
        )
        ends = f"{'.'.join(connection.source)} feeds {'.'.join(connection.target)}"
        if target.causality == "parameter":
            raise InputError(f"{ends}: OSP-IS has no connections to parameters")
        if source.type is not target.type:
            raise InputError(f"{ends}: libcosim connects variables of one type only")
        if source.items or target.items or target.type is bytes:
            raise InputError(f"{ends}: libcosim connects no enumerations and no bytes")

    def _add_simulator(self, simulators: Any, name: str, part: Part) -> None:
        element = _add(simulators, "Simulator", name=name, source=f"{name}.fmu")
        if part.every > 1:
            element.set("stepSize", repr(seconds(part.every * self._system.rig.step_ns)))
        if not part.given:
            return
        values = _add(element, "InitialValues")
        for variable, given in sorted(part.given.items()):
            described = part.instance.variables[variable]
            if described.items or described.type is bytes:
                raise InputError(
                    f"{part.name}.{variable}: OSP-IS has no values of enumerations and bytes"
                )
            initial = _add(values, "InitialValue", variable=variable)
            _add(initial, type_name(type(given.value)), value=written(given.value))

    def _add_connection(
        self, functions: Any, connections: Any, source: End, target: End, made: Connection
    ) -> None:
        if (made.factor, made.offset) == (1.0, 0.0):
            connection = _add(connections, "VariableConnection")
            bond = self._bonds.get(made.target)
            if bond is not None:
                connection.set("powerBond", bond)
            for (simulator, variable), causality in ((source, "output"), (target, "input")):
                element = _add(connection, "Variable", simulator=simulator, name=variable)
                if bond is not None:
                    element.set("causality", causality)
            return
        name = self._function("_".join(target))
        numbers = {"factor": repr(made.factor), "offset": repr(made.offset)}
        _add(functions, "LinearTransformation", name=name, **numbers)
        _add_signal(connections, name, "in", source)
        _add_signal(connections, name, "out", target)

    def _add_sum(self, functions: Any, connections: Any, source: End, target: End) -> None:
        """Add a Sum for one input: a function's output is connected once, its inputs too."""
        sum_, out = source
        terms = self._part(source).instance.feedthrough[out]
        name = self._function("_".join(target))
        _add(functions, "Sum", name=name, inputCount=str(len(terms)))
        for number, term in enumerate(terms):
            if (sum_, term) not in self._made:
                raise InputError(f"{sum_}.{term}: nothing feeds it, which libcosim does not take")
            feeder, connection = self._made[sum_, term]
            self._refuse_around_sum(feeder, connection)
            _add_signal(connections, name, f"in[{number}]", feeder)
        self._refuse_around_sum(target, self._made[target][1])
        _add_signal(connections, name, "out", target)

    def _refuse_around_sum(self, other: End, connection: Connection) -> None:
        if self._part(other).is_sum or (connection.factor, connection.offset) != (1.0, 0.0):
            raise InputError(
                f"{'.'.join(connection.source)} feeds {'.'.join(connection.target)}: libcosim "
                "connects no function to another"
            )

    def _function(self, wished: str) -> str:
        name = unused(wished, self._taken)
        self._taken.add(name)
        return name


def _add_signal(connections: Any, function: str, signal: str, end: End) -> None:
    connection = _add(connections, "SignalConnection")
    _add(connection, "Variable", simulator=end[0], name=end[1])
    _add(connection, "Signal", function=function, name=signal)


def _add(parent: Any, element: str, /, **attributes: str) -> Any:
    try:
        return etree.SubElement(parent, f"{{{NAMESPACE}}}{element}", attributes)
    except ValueError:
        raise InputError(f"XML cannot hold one of the texts {list(attributes.values())}") from None
