"""Variable groups of OSP-IS as libcosim connects them: variable by variable, in their order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from seatrial.errors import InputError, unknown
from seatrial.fmi.files.osp import osp_file
from seatrial.fmi.files.terminals import attribute
from seatrial.fmi.files.xmlfile import read_xml
from seatrial.fmi.interfaces.loaded import LoadedFmu


@dataclass(frozen=True)
class Group:
    """A group: its variables, and the groups inside it."""

    name: str
    variables: tuple[str, ...]
    groups: tuple[Group, ...]

    def all(self) -> Iterator[Group]:
        """Yield this group and those inside."""
        yield self
        for group in self.groups:
            yield from group.all()

    def flat(self) -> list[str]:
        """Return all variables, those of inner groups after its own."""
        return [*self.variables, *(name for group in self.groups for name in group.flat())]


class Groups:
    """The variable groups of one FMU; ``beside`` is the folder of the system structure.

    The file stands beside the FMU, or in that folder. Raises InputError with file and line.
    """

    def __init__(self, fmu: LoadedFmu, beside: Path) -> None:
        name = fmu.description.modelName or ""
        files = [osp_file(folder, name) for folder in (fmu.path.parent, beside)]
        # Any text may be a modelName: no other folder.
        found = [f for f in files if Path(name).name == name and f.is_file()]
        groups = _read(found[0], fmu) if found else ()
        self._top, self._all = _by_name(groups), _by_name(g for one in groups for g in one.all())
        self._file = found[0] if found else files[0]

    def named(self, name: str) -> Group:
        """Return the group ``name``; one inside others only if none at the top has the name."""
        found = self._top.get(name) or self._all.get(name)
        if not found:
            if not self._file.is_file():
                raise InputError(f"group {name!r}: there is no file {self._file.name}")
            raise InputError(f"{self._file.name}: {unknown('group', name, self._all)}")
        if len(found) > 1:
            raise InputError(f"{self._file.name}: {len(found)} groups are called {name!r}")
        return found[0]


def pairs(one: Group, other: Group) -> Iterator[tuple[str, str]]:
    """Yield what two groups connect. Raises InputError if they are not alike."""
    for what in ("variables", "groups"):
        counts = [len(getattr(group, what)) for group in (one, other)]
        if counts[0] != counts[1]:
            raise InputError(
                f"group {one.name!r} has {counts[0]} {what}, group {other.name!r} has {counts[1]}"
            )
    yield from zip(one.variables, other.variables, strict=True)
    for a, b in zip(one.groups, other.groups, strict=True):
        yield from pairs(a, b)


def _by_name(groups: Iterable[Group]) -> dict[str, list[Group]]:
    found: dict[str, list[Group]] = {}
    for group in groups:
        found.setdefault(group.name, []).append(group)
    return found


def _read(file: Path, fmu: LoadedFmu) -> tuple[Group, ...]:
    root = read_xml(file, file.name)
    if _name(root) != "OspModelDescription":
        raise InputError(
            f"{file.name}: an element OspModelDescription is needed, found {_name(root)}"
        )
    try:
        return tuple(
            _group(element, fmu.variables) for element in root.iterfind("{*}VariableGroups/{*}*")
        )
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from None


def _group(element: Any, known: Mapping[str, Any]) -> Group:
    variables, groups = [], []
    for one in element.iterchildren(tag=etree.Element):
        if _name(one) != "Variable":
            groups.append(_group(one, known))
            continue
        variables.append(attribute(one, "ref"))
        if variables[-1] not in known:
            raise InputError(f"line {one.sourceline}: {unknown('variable', variables[-1], known)}")
    return Group(attribute(element, "name"), tuple(variables), tuple(groups))


def _name(element: Any) -> str:
    return str(etree.QName(element).localname)
