"""Networks of ONNX files: chains of dense layers, activations and scales."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, listed

from .network import ALPHAS, MOST, Array, Steps, finite

_ACTIVATIONS = {
    "Relu": "relu",
    "Tanh": "tanh",
    "Sigmoid": "sigmoid",
    "Softplus": "softplus",
    "Elu": "elu",
    "LeakyRelu": "leaky_relu",
}
_PASSED = ("Identity", "Flatten", "Cast", "Dropout")
"""Operators that leave the numbers of one sample as they are."""
_SCALES = ("Add", "Sub", "Mul", "Div")
_FOLDED = ("Identity", "Cast", "Transpose", "Reshape", "Squeeze", "Unsqueeze", "Neg")
"""Operators of constants. Axes of length 1 are left out where a constant is used."""
OPERATORS = sorted({"Gemm", "MatMul", "Clip", "Constant", *_SCALES, *_PASSED, *_ACTIVATIONS})


def read_onnx(path: Path, output: str | None) -> Steps:
    """Return the network of ``path``: what leads from the graph's input to its output.

    Numbers of any float type become doubles. External data are read from beside the file. Raises
    InputError naming file, node and operator for what is no chain of `OPERATORS`.
    """
    return _Chain(path, _model(path), output).read()


def _model(path: Path) -> Any:
    try:
        import onnx
    except ImportError:
        raise InputError(
            f'{path}: ONNX needs onnx, which is not installed: pip install "seatrial[onnx]"'
        ) from None
    from google.protobuf.message import DecodeError
    from onnx.inliner import inline_local_functions

    try:
        model = onnx.load(path)
        if not model.ListFields() or not model.HasField("graph"):
            raise InputError(f"{path}: not ONNX, or cut: it has no graph")
        onnx.checker.check_model(model)
        return inline_local_functions(model) if model.functions else model
    except (DecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not ONNX, or cut: {error}") from None
    except (onnx.checker.ValidationError, ValueError, RuntimeError, OSError) as error:
        why = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read: {why}") from None


class _Chain:
    """A graph that is gone through from its input to one output."""

    def __init__(self, path: Path, model: Any, output: str | None) -> None:
        self.path, self.model, self.graph = path, model, model.graph
        self.constants: dict[str, Any] = {}
        for tensor in self.graph.initializer:
            self.constants[tensor.name] = self._array(tensor, f"initialiser {tensor.name!r}")
        self.input = self._only_input()
        self.output = self._chosen(output)

    def read(self) -> Steps:
        """Return the steps."""
        nodes = list(self._nodes())
        found = Steps(self._width(nodes))
        value = self.input.name
        for node in nodes:
            where = self._where(node)
            taken = [name for name in node.input if name and name not in self.constants]
            if taken != [value]:
                raise InputError(
                    f"{where}: it takes {listed(taken)}; each operator must take what the one "
                    f"before it gives, here {value!r}, and constants"
                )
            self._step(found, node, value, where)
            value = node.output[0]
        if value != self.output:
            raise InputError(f"{self.path}: output {self.output!r} does not depend on the input")
        return found

    # ------------------------------------------------------------------ the graph

    def _only_input(self) -> Any:
        given = [each for each in self.graph.input if each.name not in self.constants]
        if len(given) != 1:
            raise InputError(
                f"{self.path}: one input is needed, found {listed([g.name for g in given])}"
            )
        return given[0]

    def _chosen(self, output: str | None) -> str:
        names = [each.name for each in self.graph.output]
        if output is None and len(names) == 1:
            return str(names[0])
        if output is None or output not in names:
            found = "" if output is None else f", found {output!r}"
            raise InputError(
                f"{self.path}: it has the outputs {listed(names)}; network_output is to name "
                f"one{found}"
            )
        return output

    def _nodes(self) -> Iterator[Any]:
        """Yield the nodes that the output depends on; those of constants are worked out."""
        makers = {name: node for node in self.graph.node for name in node.output}
        needed, todo = set(), [self.output]
        while todo:
            node = makers.get(todo.pop())
            if node is not None and id(node) not in needed:
                needed.add(id(node))
                todo += node.input
        for node in self.graph.node:
            if id(node) not in needed:
                continue
            if node.op_type == "Constant":
                self.constants[node.output[0]] = self._constant(node)
            elif all(name in self.constants for name in node.input if name):
                self._fold(node)
            else:
                yield node

    def _width(self, nodes: list[Any]) -> int:
        """Return how many numbers the network takes: as its first layer, else as its input."""
        for node in nodes:
            if node.op_type in ("Gemm", "MatMul") and node.input[1] in self.constants:
                weights = self.constants[node.input[1]]
                if weights.ndim == 2:
                    return int(weights.shape[1 if _attribute(node, "transB", 0) else 0])
        shape = [each.dim_value for each in self.input.type.tensor_type.shape.dim]
        own = shape[1:] if len(shape) > 1 else shape
        if not own or not all(own):
            raise InputError(
                f"{self.path}: input {self.input.name!r}: how many numbers is not said"
            )
        return math.prod(own)

    # ------------------------------------------------------------------ constants

    def _array(self, tensor: Any, called: str) -> Any:
        from onnx import numpy_helper

        if math.prod(tensor.dims) > MOST:
            raise InputError(f"{self.path}: {called}: more than {MOST} numbers")
        try:
            array = numpy_helper.to_array(tensor)
        except (ValueError, TypeError, KeyError) as error:
            raise InputError(f"{self.path}: {called}: {error}") from None
        if array.dtype.kind not in "fiu":
            raise InputError(f"{self.path}: {called}: numbers are needed, found {array.dtype}")
        return finite(array.astype(np.float64), f"{self.path}: {called}")

    def _constant(self, node: Any) -> Any:
        value = {each.name: each for each in node.attribute}
        if "value" in value:
            return self._array(value["value"].t, f"node {node.output[0]!r}")
        for name, kind in (("value_float", "f"), ("value_int", "i")):
            if name in value:
                return np.array(float(getattr(value[name], kind)))
        for name, kind in (("value_floats", "floats"), ("value_ints", "ints")):
            if name in value:
                return np.array(list(getattr(value[name], kind)), dtype=np.float64)
        raise InputError(f"{self._where(node)}: a constant that is no number")

    def _fold(self, node: Any) -> None:
        """Work out an operator of constants."""
        if node.op_type not in _FOLDED or node.domain not in ("", "ai.onnx"):
            raise InputError(f"{self._where(node)}: unknown operator of constants; {_known()}")
        values = [self.constants[name] for name in node.input if name]
        made = values[0]
        try:
            if node.op_type == "Transpose":
                made = np.transpose(made, _attribute(node, "perm", None))
            elif node.op_type == "Reshape":
                made = made.reshape([int(each) for each in values[1]])
            elif node.op_type == "Neg":
                made = -made
        except (ValueError, TypeError, IndexError) as error:
            raise InputError(f"{self._where(node)}: {error}") from None
        self.constants[node.output[0]] = made

    # ------------------------------------------------------------------ operators

    def _step(self, found: Steps, node: Any, value: str, where: str) -> None:
        """Add what a node does to ``value``."""
        operator = node.op_type
        if node.domain not in ("", "ai.onnx"):
            operator = f"{node.domain}.{operator}"
        if operator in ("Gemm", "MatMul"):
            self._dense(found, node, value, where)
        elif operator in _SCALES:
            self._scale(found, node, value, where)
        elif operator == "Clip":
            low = self._limit(node, 1, "min", -math.inf, where)
            high = self._limit(node, 2, "max", math.inf, where)
            found.clip(low, high, where)
        elif operator in _ACTIVATIONS:
            kind = _ACTIVATIONS[operator]
            found.activate(kind, float(_attribute(node, "alpha", ALPHAS.get(kind, 0.0))), where)
        elif operator not in _PASSED:
            raise InputError(f"{where}: unknown operator; {_known()}")

    def _limit(self, node: Any, place: int, name: str, default: float, where: str) -> float:
        """Return a limit of Clip: an input, before opset 11 an attribute."""
        if len(node.input) > place and node.input[place]:
            return float(self._spread(self.constants[node.input[place]], 1, where)[0])
        return float(_attribute(node, name, default))

    def _dense(self, found: Steps, node: Any, value: str, where: str) -> None:
        if node.input[0] != value or node.input[1] not in self.constants:
            raise InputError(f"{where}: the value of the run is to be multiplied by a constant")
        weights = self.constants[node.input[1]]
        if weights.ndim != 2:
            raise InputError(f"{where}: a matrix is needed, found shape {weights.shape}")
        if _attribute(node, "transA", 0):
            raise InputError(f"{where}: transA = 1 makes no layer")
        if not _attribute(node, "transB", 0):
            weights = weights.T
        weights = weights * float(_attribute(node, "alpha", 1.0))
        offsets = np.zeros(len(weights))
        if len(node.input) > 2 and node.input[2]:
            own = self.constants[node.input[2]] * float(_attribute(node, "beta", 1.0))
            offsets = self._spread(own, len(weights), where)
        found.dense(np.ascontiguousarray(weights), offsets, where)

    def _scale(self, found: Steps, node: Any, value: str, where: str) -> None:
        is_first = node.input[0] == value
        other = self._spread(self.constants[node.input[1 if is_first else 0]], found.outputs, where)
        one, none = np.ones(found.outputs), np.zeros(found.outputs)
        match node.op_type:
            case "Add":
                found.scale(one, other, where)
            case "Sub":
                found.scale(*((one, -other) if is_first else (-one, other)), where)
            case "Mul":
                found.scale(other, none, where)
            case _:
                if not is_first or not np.all(other):
                    raise InputError(f"{where}: a division by the value of the run, or by 0")
                found.scale(1.0 / other, none, where)

    def _spread(self, array: Any, size: int, where: str) -> Array:
        """Return a constant as one number for each value of a sample."""
        own = np.asarray(array, dtype=np.float64)
        while own.ndim > 1 and own.shape[0] == 1:
            own = own[0]
        try:
            return np.array(np.broadcast_to(own, (size,)))
        except ValueError:
            raise InputError(
                f"{where}: a constant of shape {np.shape(array)} for {size} values"
            ) from None

    def _where(self, node: Any) -> str:
        return f"{self.path}: node {node.name or node.output[0]!r} ({node.op_type})"


def _attribute(node: Any, name: str, default: Any) -> Any:
    import onnx

    for each in node.attribute:
        if each.name == name:
            return onnx.helper.get_attribute_value(each)
    return default


def _known() -> str:
    return f"a policy has {', '.join(OPERATORS)}"
