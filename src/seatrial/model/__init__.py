"""Components as they are written: ports, units, states, equations, noise, faults of signals."""
