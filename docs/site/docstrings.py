"""Griffe extension for the library reference: ports described by their declaration, tables kept."""

from __future__ import annotations

import ast
import re
from typing import Any

import griffe

PORTS = {"Parameter": 1, "Input": 0, "Output": 0, "State": 0}
"""Kinds of ports, and which of their arguments is the unit; the description comes next."""
TABLE = re.compile(r"^(=+ +=+)\n(.*?)\n\1$", re.MULTILINE | re.DOTALL)
"""A table of two columns between two rows of equals signs."""


class Docstrings(griffe.Extension):
    """Make docstrings what the reference can show."""

    def on_instance(self, *, obj: griffe.Object | griffe.Alias, **_: Any) -> None:
        """Show tables as they are written."""
        if isinstance(obj, griffe.Object) and obj.docstring:
            obj.docstring.value = TABLE.sub(r"```text\n\2\n```", obj.docstring.value)

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Describe a port by its declaration."""
        if attr.docstring or not isinstance(attr.value, griffe.ExprCall):
            return
        place = PORTS.get(str(attr.value.function).rpartition(".")[2])
        if place is None:
            return
        try:
            unit, description = (
                ast.literal_eval(str(each)) for each in attr.value.arguments[place : place + 2]
            )
        except (ValueError, SyntaxError):
            return  # put together from other names
        shown = f"{description}, {unit}" if isinstance(unit, str) and unit != "1" else description
        attr.docstring = griffe.Docstring(str(shown), parent=attr)
