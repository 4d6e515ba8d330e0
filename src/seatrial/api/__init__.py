"""The Python API: simulations that the caller steps, trials and campaigns that run whole.

Modules here import what is heavy (NumPy, CasADi, FMPy) when it is used: importing them is cheap.
"""
