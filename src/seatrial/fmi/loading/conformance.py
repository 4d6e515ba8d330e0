"""The check of an FMU against its standard, in time that grows with its variables and no faster."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator
from itertools import islice

from fmpy.model_description import ValidationError, read_model_description
from lxml import etree

from ..files.xmlfile import read_xml
from ..interfaces.loaded import LoadedFmu

LARGEST_CHECKED = 256 * 2**20
"""Bytes of a model description; of a larger one FMPy's checker would hold some 5 GB and more."""
_MOST_PROBLEMS = 100
_LONGEST = 1000
"""Characters of a problem: some list all variables there are."""

# FMI 2.0.4, 2.2.9, and FMI 3.0, 2.4.8: the names of the structured naming convention.
_QUOTABLE = r"[_a-zA-Z0-9!#$%&()*+,\-./:;<>=?@\[\]^{}| ]|\\['\"?\\abfnrtv]"
_PART = rf"(?:[_a-zA-Z][_a-zA-Z0-9]*+|'(?:{_QUOTABLE})++')(?:\[\d+(?:,\d+)*+\])?"
_IDENTIFIER = rf"{_PART}(?:\.{_PART})*+"
_STRUCTURED = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,\d+)?\)")
_FLAT = re.compile(r"[^\r\n\t]*")


def problems(fmu: LoadedFmu) -> list[str]:
    """Return what breaks FMI in the model description and the names of files.

    Of very many problems the first, and a line that says so.
    """
    found = [*_file_names(fmu), *_of_description(fmu)]
    found += islice(_names(fmu), _MOST_PROBLEMS + 1)
    shown = [_shortened(problem) for problem in found[:_MOST_PROBLEMS]]
    if len(found) > _MOST_PROBLEMS:
        shown.append(f"... and more problems, of which the first {_MOST_PROBLEMS} are listed")
    return shown


def is_whole(fmu: LoadedFmu) -> bool:
    """Say if `problems` checks all of an FMU: of a very large one FMPy's part is left out."""
    return fmu.model.path.stat().st_size <= LARGEST_CHECKED


def _file_names(fmu: LoadedFmu) -> Iterator[str]:
    with zipfile.ZipFile(fmu.path) as archive:
        for info in archive.infolist():
            if "\\" in info.orig_filename:
                yield f'The file path "{info.orig_filename}" contains a backslash.'


def _of_description(fmu: LoadedFmu) -> list[str]:
    """Return what FMPy says of schema, start values, units and model structure.

    Not of names: its parser takes milliseconds for each.
    """
    if not is_whole(fmu):
        return []
    try:
        read_model_description(_known_to_fmpy(fmu), validate=True, validate_model_structure=True)
    except ValidationError as error:
        return [str(problem) for problem in error.problems]
    except Exception as error:  # whatever it meets in a description that it does not expect
        return [str(error) or type(error).__name__]
    return []


def _known_to_fmpy(fmu: LoadedFmu) -> str | io.BytesIO:
    """Return what FMPy's checker takes: it refuses clocks that have a ClockType."""
    if fmu.model.root.find("TypeDefinitions/ClockType") is None:
        return str(fmu.folder)
    root = read_xml(fmu.model.path, fmu.model.called)
    for clock in root.iterfind("ModelVariables/Clock[@declaredType]"):
        del clock.attrib["declaredType"]
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("modelDescription.xml", etree.tostring(root, encoding="UTF-8"))
    return content


def _names(fmu: LoadedFmu) -> Iterator[str]:
    """Yield the variables whose names break the naming convention."""
    convention = fmu.model.root.get("variableNamingConvention", "flat")
    allowed = _STRUCTURED if convention == "structured" else _FLAT
    for element in fmu.model.variables():
        name = element.get("name")
        if not allowed.fullmatch(name):
            yield (
                f"{name!r} (line {element.sourceline}) is not a legal variable name for naming "
                f'convention "{convention}".'
            )


def _shortened(problem: str) -> str:
    return problem if len(problem) <= _LONGEST else f"{problem[:_LONGEST]} ..."
