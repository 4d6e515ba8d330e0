"""Dense layers: a function of C for each, over tables of its numbers."""

from __future__ import annotations

from typing import Any

from seatrial.model.dense import dense

from .domain import Known, Num, Seq
from .expressions import unpacked
from .frame import Frame
from .library import array, library

_TEXT = """\
struct {name} {{ double y[{rows}]; }};
static struct {name} {name}(const double *x) {{
    struct {name} found;
    for (int i = 0; i < {rows}; i++) {{
        double sum = {offsets}[i];
        for (int j = 0; j < {columns}; j++) sum += {weights}[i * {columns} + j] * x[j];
        found.y[i] = sum;
    }}
    return found;
}}
"""


@library(dense)
def _dense(frame: Frame, layer: Any, values: Any) -> Seq:
    if not isinstance(layer, Known):
        raise frame.refused("a layer that the run decides")
    unit, own = frame.unit, layer.value
    key = (dense, id(own))
    if key not in unit.written:
        rows, columns = own.weights.shape
        unit.counter += 1
        name = f"f{unit.counter}_dense"
        text = _TEXT.format(
            name=name,
            rows=rows,
            columns=columns,
            weights=unit.constant_table(own.weights.ravel().tolist())[0],
            offsets=unit.constant_table(own.offsets.tolist())[0],
        )
        unit.functions.append((name, text))
        unit.written[key] = name, rows
    name, rows = unit.written[key]
    whole = frame.variable("d").replace("d", "r", 1)
    frame.variables[-1] = (f"struct {name}", whole)
    frame.emit(f"{whole} = {name}({array(frame, unpacked(frame, values))});")
    return Seq(list, [Num("d", f"{whole}.y[{i}]") for i in range(rows)])
