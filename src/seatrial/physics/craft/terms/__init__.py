"""Terms of a hull's hydrodynamics, and the context that they are given."""
