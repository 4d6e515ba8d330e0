"""seatrial: sea trials before the water.

FMI co-simulation components and a software-in-the-loop harness for marine robots.
"""

__version__ = "0.1.0"
