"""ONNX files, as ONNX Runtime and PyTorch understand and write them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.learning.network_file import read_network
from seatrial_kits.learning.policy_file import frozen_policy

from .policies import ports, read_or_refused, started

onnx: Any = pytest.importorskip("onnx", reason="networks of ONNX files need onnx")
from onnx import TensorProto, helper, numpy_helper  # noqa: E402

pytestmark = pytest.mark.interop
RANDOM = np.random.default_rng(11)
B, C = RANDOM.normal(size=(4, 5)), RANDOM.normal(size=5)
X = RANDOM.normal(size=4)


def model(nodes: list[Any], constants: dict[str, Any], kind: Any = np.float32, **other: Any) -> Any:
    """Return a model from x, four numbers, to y."""
    tensors = [numpy_helper.from_array(np.asarray(v, kind), n) for n, v in constants.items()]
    element = TensorProto.FLOAT if kind is np.float32 else TensorProto.DOUBLE
    given = helper.make_tensor_value_info("x", element, other.get("shape", ["batch", 4]))
    outputs = [
        helper.make_tensor_value_info(name, element, ["batch", "n"])
        for name in other.get("outputs", ["y"])
    ]
    graph = helper.make_graph(nodes, "net", [given], outputs, tensors)
    opset = helper.make_opsetid("", other.get("opset", 17))
    return helper.make_model(graph, opset_imports=[opset], ir_version=8)


def answer(path: Path, x: Any, outputs: int, output: str | None = None) -> list[float]:
    text = ports(len(x), outputs).replace("net.npz", path.name)
    if output:
        text = f'network_output = "{output}"\n{text}'
    path.with_name("policy.toml").write_text(text, "utf-8")
    component = started(path.with_name("policy.toml"))
    component.set("x", x)
    found: list[float] = component.get("y")
    return found


def by_runtime(path: Path, x: Any, output: str | None = None) -> Any:
    runtime = pytest.importorskip("onnxruntime", reason="ONNX Runtime is the reference tool")
    session = runtime.InferenceSession(str(path))
    kind = np.float64 if "double" in session.get_inputs()[0].type else np.float32
    outputs = None if output is None else [output]
    return session.run(outputs, {session.get_inputs()[0].name: np.array([x], kind)})[0][0]


def agree(path: Path, output: str | None = None, x: Any = X, rel: float = 1e-5) -> None:
    expected = by_runtime(path, x, output)
    assert answer(path, x, len(expected), output) == pytest.approx(expected, rel=rel, abs=rel)


def gemm(**attributes: Any) -> Any:
    return helper.make_node("Gemm", ["x", "B", "C"], ["h"], name="first", **attributes)


def then(operator: str, *inputs: str, **attributes: Any) -> Any:
    return helper.make_node(operator, ["h", *inputs], ["y"], name="second", **attributes)


ONE = {"B": B, "C": C}
MODELS = {
    "gemm": ([gemm(), then("Identity")], ONE),
    "gemm-transposed": ([gemm(transB=1, alpha=0.5, beta=-2.0), then("Tanh")], {"B": B.T, "C": C}),
    "gemm-one-offset": ([gemm(), then("Relu")], {"B": B, "C": [0.5]}),
    "matmul-add": (
        [
            helper.make_node("MatMul", ["x", "B"], ["m"]),
            helper.make_node("Add", ["C", "m"], ["h"]),
            then("Sigmoid"),
        ],
        ONE,
    ),
    "elu": ([gemm(), then("Elu", alpha=0.3)], ONE),
    "elu-default": ([gemm(), then("Elu")], ONE),
    "leaky": ([gemm(), then("LeakyRelu", alpha=0.2)], ONE),
    "leaky-default": ([gemm(), then("LeakyRelu")], ONE),
    "softplus": ([gemm(), then("Softplus")], ONE),
    "clip": ([gemm(), then("Clip", "low", "high")], {**ONE, "low": -0.5, "high": 1.0}),
    "clip-above": ([gemm(), then("Clip", "", "high")], {**ONE, "high": 0.5}),
    "sub": ([gemm(), helper.make_node("Sub", ["k", "h"], ["y"])], {**ONE, "k": [[1, 2, 3, 4, 5]]}),
    "div": ([gemm(), then("Div", "k")], {**ONE, "k": [1, 2, 3, 4, 5]}),
    "mul": ([gemm(), then("Mul", "k")], {**ONE, "k": -2.5}),
    "normalised": (
        [
            helper.make_node("Flatten", ["x"], ["f"]),
            helper.make_node("Sub", ["f", "mean"], ["s"]),
            helper.make_node("Div", ["s", "scale"], ["n"]),
            helper.make_node("Gemm", ["n", "B", "C"], ["h"]),
            then("Tanh"),
        ],
        {**ONE, "mean": X + 0.1, "scale": [1, 2, 0.5, 3]},
    ),
    "folded": (
        [
            helper.make_node("Transpose", ["B"], ["T"], perm=[1, 0]),
            helper.make_node("Gemm", ["x", "T", "C"], ["h"]),
            then("Cast", to=TensorProto.FLOAT),
        ],
        {"B": B.T, "C": C},
    ),
    "constant": (
        [gemm(), helper.make_node("Constant", [], ["k"], value_float=2.0), then("Mul", "k")],
        ONE,
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_operators_are_those_of_onnx_runtime(name: str, tmp_path: Path) -> None:
    onnx.save(model(*MODELS[name]), tmp_path / "net.onnx")
    agree(tmp_path / "net.onnx")


def test_doubles_stay_doubles(tmp_path: Path) -> None:
    onnx.save(model([gemm(), then("Tanh")], ONE, np.float64), tmp_path / "net.onnx")
    found = answer(tmp_path / "net.onnx", X, 5)
    assert found == pytest.approx(np.tanh(X @ B + C), rel=1e-14)
    agree(tmp_path / "net.onnx", rel=1e-14)


def test_typed_data_and_old_limits(tmp_path: Path) -> None:
    made = model([gemm(), then("Clip", min=-0.25, max=0.75)], {}, opset=8)
    for name, value in ONE.items():
        flat = np.asarray(value).ravel().tolist()
        made.graph.initializer.append(
            helper.make_tensor(name, TensorProto.FLOAT, np.shape(value), flat)
        )
    assert made.graph.initializer[0].float_data
    onnx.save(made, tmp_path / "net.onnx")
    agree(tmp_path / "net.onnx")


def test_weights_beside_the_file(tmp_path: Path) -> None:
    made = model([gemm(), then("Tanh")], ONE)
    onnx.save(
        made, tmp_path / "net.onnx", save_as_external_data=True, location="w.data", size_threshold=0
    )
    agree(tmp_path / "net.onnx")
    (tmp_path / "w.data").unlink()
    with pytest.raises(InputError, match=r"net\.onnx: cannot be read: .*w\.data"):
        read_network(tmp_path / "net.onnx", None)


def test_one_of_several_outputs(tmp_path: Path) -> None:
    value = helper.make_node("ReduceSum", ["h"], ["value"])
    onnx.save(
        model([gemm(), value, then("Tanh")], ONE, outputs=["value", "y"]), tmp_path / "net.onnx"
    )
    agree(tmp_path / "net.onnx", "y")
    for output in (None, "z"):
        with pytest.raises(
            InputError, match=r"it has the outputs .*value.*y.*; network_output is to name one"
        ):
            read_network(tmp_path / "net.onnx", output)


@pytest.mark.parametrize(
    ("nodes", "constants", "message"),
    [
        ([gemm(), then("Softmax")], ONE, r"node 'second' \(Softmax\): unknown operator; a policy has .*Tanh"),
        ([gemm(), then("Mul", "h")], ONE, r"node 'second' \(Mul\): it takes h.* and constants"),
        ([gemm(), helper.make_node("Div", ["k", "h"], ["y"])], {**ONE, "k": 1.0}, r"\(Div\): a division by"),
        ([gemm(), then("Add", "k")], {**ONE, "k": [1.0, 2.0]}, r"\(Add\): a constant of shape \(2,\) for 5"),
        ([gemm(), then("Tanh")], {**ONE, "C": [np.nan] * 5}, r"initialiser 'C': nan at \[0\]"),
        ([gemm(transA=1), then("Tanh")], ONE, r"node 'first' \(Gemm\): transA"),
        ([helper.make_node("MatMul", ["x", "x"], ["y"], name="m")], ONE, r"'m' \(MatMul\): it takes"),
        ([helper.make_node("Exp", ["C"], ["k"], name="e"), gemm(), then("Add", "k")], ONE, r"'e' \(Exp\): unknown operator of constants"),
    ],
)  # fmt: skip
def test_what_is_no_chain_of_layers(
    nodes: Any, constants: Any, message: str, tmp_path: Path
) -> None:
    onnx.save(model(nodes, constants), tmp_path / "net.onnx")
    with pytest.raises(InputError, match=rf"net\.onnx: .*{message}"):
        read_network(tmp_path / "net.onnx", None)


def test_cut_and_damaged_files(tmp_path: Path) -> None:
    path = tmp_path / "net.onnx"
    content = model([gemm(), then("Tanh")], ONE).SerializeToString()
    random = np.random.default_rng(5)
    for size in (0, 1, 10, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(InputError, match=r"net\.onnx: "):
            read_network(path, None)
    for _ in range(200):
        damaged = bytearray(content)
        damaged[random.integers(len(content))] ^= int(random.integers(1, 256))
        path.write_bytes(damaged)
        read_or_refused(path)


def test_without_onnx_the_message_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    onnx.save(model([gemm(), then("Tanh")], ONE), tmp_path / "net.onnx")
    monkeypatch.setitem(sys.modules, "onnx", None)
    (tmp_path / "policy.toml").write_text(ports(4, 5).replace("net.npz", "net.onnx"), "utf-8")
    with pytest.raises(InputError, match=r'ONNX needs onnx, .*: pip install "seatrial\[onnx\]"'):
        frozen_policy(tmp_path / "policy.toml")


@pytest.mark.slow
def test_networks_that_pytorch_exports(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch", reason="PyTorch exports the network")
    nn = torch.nn
    layers = [nn.Flatten(), nn.Linear(4, 8), nn.Tanh(), nn.Linear(8, 8), nn.ReLU(), nn.Linear(8, 8)]
    layers += [nn.ELU(), nn.Linear(8, 8), nn.LeakyReLU(0.2), nn.Linear(8, 8), nn.Softplus()]
    net = nn.Sequential(*layers, nn.Dropout(), nn.Linear(8, 2), nn.Hardtanh()).eval()
    path = tmp_path / "net.onnx"
    torch.onnx.export(net, (torch.zeros(1, 4),), str(path), dynamo=False)
    agree(path)
    with torch.no_grad():
        expected = net(torch.tensor([X.tolist()]))[0].numpy()
    assert answer(path, X, 2) == pytest.approx(expected, rel=1e-5, abs=1e-6)
