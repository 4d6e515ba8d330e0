"""Mutation check of the equations: changes that a test must notice, and what noticed them."""
