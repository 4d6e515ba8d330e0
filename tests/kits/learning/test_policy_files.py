"""Files of policies with mistakes: the message names the file, the key and what is allowed."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.learning.policy_file import frozen_policy

from .policies import LAYERS, PLAIN, read_or_refused, write


def without(key: str) -> dict[str, Any]:
    return {name: value for name, value in LAYERS.items() if name != key}


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (without("b0"), r"net\.npz: b0: is not there; the keys are W0, activations"),
        (without("W0"), r"net\.npz: weights W0, W1, .* are needed"),
        (without("activations"), r"net\.npz: activations: is not there"),
        (LAYERS | {"b0": [1.0]}, r"net\.npz: W0, b0: 2 offsets are needed.*found shape \(1,\)"),
        (LAYERS | {"b0": [[1.0, 2.0]]}, r"net\.npz: b0: a row of numbers is needed, found shape"),
        (LAYERS | {"W0": [1.0]}, r"net\.npz: W0: a matrix is needed, found shape \(1,\)"),
        (LAYERS | {"W0": [["a"]]}, r"net\.npz: W0: numbers are needed, found <U1"),
        (LAYERS | {"W0": [[1, np.nan, 0], [0, 0, 0]]}, r"net\.npz: W0, b0: nan at \[0, 1\]"),
        (LAYERS | {"b0": [1.0, np.inf]}, r"net\.npz: W0, b0: inf at \[1\]"),
        (
            LAYERS | {"activations": ["tanhh"]},
            r"net\.npz: activations\[0\]: unknown activation 'tanhh'; did you mean 'tanh'",
        ),
        (
            LAYERS | {"activations": ["elu(a)"]},
            r"activations\[0\]: 'elu\(a\)': a number is needed in",
        ),
        (
            LAYERS | {"activations": ["tanh(1)"]},
            r"activations\[0\]: 'tanh\(1\)': tanh has no number",
        ),
        (
            LAYERS | {"activations": ["tanh", "tanh"]},
            r"net\.npz: activations: 1 are needed.*found 2",
        ),
        (LAYERS | {"activations": [1.0]}, r"net\.npz: activations: texts are needed"),
        (
            LAYERS | {"W1": [[1.0, 2.0, 3.0]], "b1": [0.0], "activations": ["tanh", "tanh"]},
            r"W1, b1: weights for 3 values, and 2 come in",
        ),
        (LAYERS | {"W2": [[1.0]], "b2": [0.0]}, r"net\.npz: W1: is not there"),
        (LAYERS | {"weights": [1.0]}, r"net\.npz: unknown key 'weights'"),
        (LAYERS | {"input_mean": [1.0]}, r"net\.npz: input_mean: 3 are needed, found 1"),
        (
            LAYERS | {"input_scale": [1.0, 0.0, 1.0]},
            r"net\.npz: input_scale: what is divided by is 0",
        ),
        (LAYERS | {"output_scale": [1.0]}, r"net\.npz: output_scale: 2 are needed, found 1"),
        (
            LAYERS | {"input_low": [1.0] * 3},
            r"net\.npz: input_low: input_low and input_high are needed",
        ),
        (
            LAYERS | {"input_low": [1.0] * 3, "input_high": [2.0, 0.0, 2.0]},
            r"input_low, input_high: 1\.0 to 0\.0 at 1",
        ),
        (
            LAYERS | {"output_low": [0.0] * 2},
            r"net\.npz: output_low: output_low and output_high are needed, both or none",
        ),
        (
            LAYERS | {"output_low": [0.0] * 2, "output_high": [np.nan, 1.0]},
            r"net\.npz: output_high: nan at \[0\]",
        ),
        (
            LAYERS | {"output_low": [0.0] * 2, "output_high": [1.0] * 3},
            r"net\.npz: output_high: 2 are needed, found 3",
        ),
    ],
)
def test_networks_with_mistakes(arrays: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        frozen_policy(write(tmp_path, arrays=arrays))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"net.npz"', '"none.npz"', r"none\.npz: No such file"),
        ('"net.npz"', '"net.pt"', r"net\.pt: a network is an \.npz or \.onnx file"),
        (
            '"net.npz"',
            '"net.npz"\nnetwork_output = "y"',
            r"has one output; network_output is for ONNX",
        ),
        ("100 ms", "100 m", r"policy\.toml: period: .*'m'"),
        ("100 ms", "0 s", r"policy\.toml: period: '0 s', at least 1 us"),
        ('unit = "m"', 'unit = "mm/q"', r"policy\.toml: inputs\.x\.unit: .*mm/q"),
        (
            'unit = "m"',
            'unit = ["m", "m"]',
            r"inputs\.x\.unit: one for each axis is needed, found 2",
        ),
        ('"a", "b", "c"', '"a", "b"', r"policy\.toml: inputs: 2 elements, and net\.npz takes 3"),
        (
            '"a", "b", "c"',
            '"a", "b", "b"',
            r"inputs\.x\.axes: 'b' is no identifier, or there twice",
        ),
        ('"p", "q"', '"p"', r"policy\.toml: outputs: 1 elements, and net\.npz gives 2"),
        ('"p", "q"]', '"p", "q"], frame = "e"', r"outputs\.y\.frame: 'e'; n or b"),
        ("\nx =", "\nm =", r"inputs\.m: that name means something else"),
        ("\nx =", "\nstep =", r"inputs\.step: that name means something else"),
        ("\nx =", '\n"x.y" =', r"inputs\.x\.y: a name has letters"),
        ("\ny =", "\nx =", r"policy\.toml: 'x' is an input and an output"),
        ("[inputs]", "[input]", r"policy\.toml: .*input"),
        (
            "[outputs]",
            "[terminals]\nall = ['z']\n[outputs]",
            r"terminals\.all: unknown port, or twice: 'z'",
        ),
    ],
)
def test_policies_with_mistakes(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert old in PLAIN
    with pytest.raises(InputError, match=message):
        frozen_policy(write(tmp_path, PLAIN.replace(old, new)))


OBSERVE = PLAIN + "".join(f'[[observe]]\nvalue = "x.{axis}"\n' for axis in "abc")
ACT = PLAIN + "".join(f'[[act]]\nto = "y.{axis}"\n' for axis in "pq")


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (OBSERVE, "x.a", "x.d", r"observe\.0\.value: unknown input 'x\.d'"),
        (OBSERVE, "x.a", "z", r"policy\.toml: observe\.0\.value: "),
        (OBSERVE, "x.a", "sin(x.a)", r"observe\.0\.value: 'sin' needs an angle, got x\.a in 'm'"),
        (OBSERVE, "x.a", "x.a + 1 s", r"observe\.0\.value: '\+' needs values of one kind"),
        (OBSERVE, "x.a", "x.a > 1 m", r"policy\.toml: observe\.0\.value: "),
        (OBSERVE, "x.a", "rms(x.a)", r"observe\.0\.value: .*whole record"),
        (OBSERVE, '"x.a"', '"x.a"\nrange = ["1 s", "2 s"]', r"observe\.0\.range: .*'s'"),
        (OBSERVE, '"x.a"', '"x.a"\nrange = [2, 1]', r"observe\.0\.range: low below high is needed"),
        (OBSERVE, '[[observe]]\nvalue = "x.c"\n', "", r"observe: 2 elements, and net\.npz takes 3"),
        (ACT, "y.p", "y.r", r"act\.0\.to: unknown output 'y\.r'"),
        (ACT, "y.q", "y.p", r"act\.1\.to: 'y\.p' is an earlier action already"),
        (ACT, '[[act]]\nto = "y.q"\n', "", r"act: no action is output 'y\.q'"),
        (ACT, '"y.p"', '"y.p"\nrange = ["1 m", "2 m"]', r"act\.0\.range: "),
    ],
)
def test_elements_with_mistakes(
    text: str, old: str, new: str, message: str, tmp_path: Path
) -> None:
    assert old in text
    with pytest.raises(InputError, match=message):
        frozen_policy(write(tmp_path, text.replace(old, new)))


def test_a_rig_is_no_policy(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"policy\.toml: it is a rig, no policy: rig = "):
        frozen_policy(write(tmp_path, 'step = "1 s"\n[components]\n'))


def test_ranges_of_training_stand_in_one_place(tmp_path: Path) -> None:
    arrays = LAYERS | {"input_low": [0.0] * 3, "input_high": [1.0] * 3}
    text = OBSERVE.replace('"x.b"', '"x.b"\ntrained = [0, 1]')
    with pytest.raises(InputError, match=r"observe\.1: net\.npz has input_low and input_high"):
        frozen_policy(write(tmp_path, text, arrays))


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_cut_and_damaged_files_are_refused_or_read(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    path = write(tmp_path_factory.mktemp("net")).with_name("net.npz")
    content = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    else:
        content[data.draw(st.integers(0, len(content) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(content)
    read_or_refused(path)


def test_no_code_of_a_file_is_run(tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self) -> Any:
            return os.system, ("exit 1",)

    arrays = LAYERS | {"b0": np.array([Trap()], dtype=object)}
    with pytest.raises(InputError, match=r"net\.npz: cannot be read: Object arrays"):
        frozen_policy(write(tmp_path, arrays=arrays))
