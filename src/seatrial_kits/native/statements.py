"""C text of a sampled or memoryless component: its methods, translated, and their tables."""

from __future__ import annotations

import sys

from seatrial.devices.fault import Fallible
from seatrial.model.component import Component, Noise
from seatrial.model.faults.catalogue import KINDS
from seatrial.model.faults.text import MEASURED

from .tables import quoted, table, tables
from .translation.intrinsics import FAULTS, SETTINGS
from .translation.unit import Unit

_FAULTS = """\
enum {{ FAULT_NAMES = {names}, FAULT_PLAIN = {plain}, FAULT_MEASURED = {measured} }};
#define FAULT_TEXT 0
#define fault_names model_fault_names
#define fault_needs model_fault_needs
#define fault_measured model_fault_measured
#define fault_settings model_fault_settings
extern const char *const fault_names[], *const fault_measured[], *const fault_settings[];
extern const int fault_needs[];
"""


class Translation:
    """A component as C. Raises `TranslationError` naming file, line and construct."""

    def __init__(self, example: Component) -> None:
        self.example = example
        self.unit = Unit(example)
        self.text = self.unit.translate()

    def header(self) -> str:
        """Return what ``model.h`` has of it."""
        memory = "\n".join(f"    {field}" for field in self.unit.memory())
        faults = self._fault_sizes() if isinstance(self.example, Fallible) else ""
        version = f"#define PYTHON {sys.version_info[0]}{sys.version_info[1]:02}\n"
        queues = [f"#define TOUCHED offsetof(Memory, {n}_e[4])\n" for n in self.unit.queues][:1]
        whole = f"typedef struct {{\n{memory or '    int none;'}\n}} Memory;\n{''.join(queues)}"
        return f"{version}\n{whole}\n{faults}"

    def model(self) -> str:
        """Return ``model.c``."""
        constants = "\n".join(self.unit.constants())
        common = tables(self.example)
        if isinstance(self.example, Fallible):
            own = self._fault_tables()
        else:
            own = "void model_text(Instance *self, int text) { (void)self, (void)text; }\n"
        return f'#include "runtime.h"\n\n{constants}\n\n{self.text}\n{own}\n{common}'

    def parts(self) -> list[str]:
        """Return the files of the runtime that it needs."""
        files = ["runtime.c", "runtime.h"]
        files += ["faults.c"] if isinstance(self.example, Fallible) else []
        return files + (["noise.c", "ziggurat.h"] if isinstance(self.example, Noise) else [])

    def _measured(self) -> list[str]:
        return ["", *(port.name for port in getattr(self.example, "measured", ()))]

    def _fault_sizes(self) -> str:
        plain, measured = len(FAULTS) - len(MEASURED), len(self._measured())
        return _FAULTS.format(names=len(FAULTS), plain=plain, measured=measured)

    def _fault_tables(self) -> str:
        needs = [
            next(SETTINGS.index(s) for s in SETTINGS if s in KINDS[m].settings) for m in MEASURED
        ]
        return "\n".join(
            [
                table("char *const", "fault_names", [quoted(name) for name in FAULTS]),
                table("char *const", "fault_measured", [quoted(n) for n in self._measured()]),
                table("char *const", "fault_settings", [quoted(name) for name in SETTINGS]),
                table("int", "fault_needs", [str(need) for need in needs]),
            ]
        )
