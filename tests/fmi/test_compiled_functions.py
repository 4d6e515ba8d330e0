"""Plants in process: compiled steps give what CasADi's virtual machine gives, to the bit."""

from __future__ import annotations

import numpy as np
import pytest

from seatrial.fmi.compiled_functions import compiled_function
from seatrial.fmi.components.index import component_class, components
from seatrial.fmi.direct import DirectInstance
from seatrial.model.plant import Plant
from tests.kit import needs_kits

QUICK = ("surface-vessel", "manoeuvring-ship")
PLANTS = [
    pytest.param(name, marks=[] if name in QUICK else pytest.mark.interop)
    for name in components().shipped
    if issubclass(component_class(name), Plant)
]


@pytest.mark.parametrize("name", PLANTS)
def test_the_bits_are_those_of_casadi(name: str) -> None:
    model = component_class(name)("plant").compiled()
    draw = np.random.default_rng(1)
    for function in (model.rk4, model.out):
        compiled = compiled_function(function)
        assert compiled.class_name() == "External"
        for _ in range(20):
            given = [draw.uniform(0.1, 2.0, function.size_in(i)) for i in range(function.n_in())]
            expected, found = np.asarray(function(*given)), np.asarray(compiled(*given))
            np.testing.assert_array_equal(expected, found)
            assert np.signbit(expected).tolist() == np.signbit(found).tolist()


@needs_kits("videoray")
def test_an_instance_in_process_uses_them() -> None:
    instance = DirectInstance(component_class("surface-vessel")("vessel"))
    instance.set_start({})
    instance.initialise(0.0, 1.0)
    assert instance.component.machine is compiled_function
