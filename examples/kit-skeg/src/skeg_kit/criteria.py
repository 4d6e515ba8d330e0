"""A function of criteria: the length of a vector in a plane."""

from __future__ import annotations

import numpy as np

from seatrial.trial.criteria.expressions import Rule, same_kind

HYPOT = Rule(np.hypot, same_kind, 2)
