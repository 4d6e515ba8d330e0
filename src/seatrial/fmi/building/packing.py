"""The description of any FMU built here by its version of FMI, and its reproducible archive."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from xml.etree.ElementTree import Element, indent, tostring

from ...model.component import Component
from ..direct import DirectInstance
from ..files.terminals import PLACE, terminals_element, xml_text
from ..version3.buses import add_bus_terminals, can_terminals, manifest
from ..version3.description import arrays, version3

_TIMESTAMP = (1980, 1, 1, 0, 0, 0)


def described_files(root: Element, component: Component, version: int) -> dict[str, bytes]:
    """Return model description and terminals, as the version of FMI has them, by path.

    ``root`` is the model description of FMI 2.0.
    """
    instance = DirectInstance(component)
    whole = arrays(component.scalars, root) if version == 3 else ()
    buses = can_terminals(component) if version == 3 else []
    files = manifest(buses)
    if instance.terminals:
        terminals = terminals_element(instance.terminals, instance.variables, whole)
        add_bus_terminals(terminals[0], buses)
        files[PLACE] = xml_text(terminals)
    described = version3(root, component.scalars, buses) if version == 3 else root
    indent(described)
    text: bytes = tostring(described, encoding="UTF-8", xml_declaration=True)
    return {"modelDescription.xml": text, **files}


def zipped(files: Mapping[str, bytes]) -> bytes:
    """Return a ZIP archive of ``files`` by name: same content, same bytes; never ZIP64."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, False, 6) as archive:
        for name, data in sorted(files.items()):
            info = zipfile.ZipInfo(name, _TIMESTAMP)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, data)
    return buffer.getvalue()
