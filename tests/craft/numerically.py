"""Equations of craft with numbers in the place of CasADi's symbols: no model is compiled."""

from types import SimpleNamespace

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation


def numbers(kind, **values):
    """Return inputs and parameters of a class: 0 and as declared, but for ``values``."""
    ports = [port for port in kind.ports.values() if port.kind in ("input", "parameter")]
    given = {port.name: port.start if port.axes else port.start[0] for port in ports} | values
    return SimpleNamespace(
        **{name: v if isinstance(v, str) else ca.DM(np.array(v)) for name, v in given.items()}
    )


def pose(draw):
    """Return attitude, rotation {b} to {n} and nu, at random."""
    attitude = draw.uniform((-3, -1.3, -3), (3, 1.3, 3))
    return attitude, Rotation.from_euler("ZYX", attitude[::-1]).as_matrix(), draw.normal(size=6)
