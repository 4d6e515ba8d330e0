"""FMUs of Python components that carry their own Python: the machine that runs them needs none."""
