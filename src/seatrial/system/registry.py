"""The coupling algorithms by the names that rig files write."""

from __future__ import annotations

from ..plugins import Registry

ALGORITHMS = Registry(
    "seatrial.algorithms",
    "algorithm",
    {
        "jacobi": "seatrial.sim.algorithms:Jacobi",
        "plain-jacobi": "seatrial.sim.algorithms:PlainJacobi",
        "gauss-seidel": "seatrial.sim.algorithms:GaussSeidel",
        "extrapolated": "seatrial.sim.algorithms:Extrapolated",
        "ecco": "seatrial.sim.ecco:Ecco",
        "iterated": "seatrial.sim.iteration:Iterated",
    },
)
