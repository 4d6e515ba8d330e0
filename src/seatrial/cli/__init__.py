"""The command line: ``seatrial run``, ``list``, ``report``, ``compare``, ``fmu``, ``doctor``.

Exit status: 0 all is well; 1 a criterion does not hold, or two runs differ; 2 bad input;
3 a simulation could not go on, or was stopped.
"""

from .starting import ending_at_once

with ending_at_once():
    from .main import main

__all__ = ["main"]
