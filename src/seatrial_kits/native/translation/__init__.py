"""From the Python of sampled and memoryless components to C: an interpreter of their syntax.

It runs a component's methods on values of which it knows the structure and not the numbers.
What is known (ports, tables, lengths of lists, text parameters) happens there and then; what is
not becomes C, operation by operation, so that both carriers give the same doubles.
"""
