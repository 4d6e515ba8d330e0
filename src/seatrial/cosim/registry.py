"""The coupling algorithms by the names that rig files write."""

from __future__ import annotations

from ..plugins import Registry

ALGORITHMS = Registry(
    "seatrial.algorithms",
    "algorithm",
    {
        "jacobi": "seatrial.cosim.algorithms:Jacobi",
        "plain-jacobi": "seatrial.cosim.algorithms:PlainJacobi",
        "gauss-seidel": "seatrial.cosim.algorithms:GaussSeidel",
        "extrapolated": "seatrial.cosim.algorithms:Extrapolated",
        "ecco": "seatrial.cosim.ecco:Ecco",
        "iterated": "seatrial.cosim.iteration:Iterated",
    },
)
