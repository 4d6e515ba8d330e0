"""Dependencies of outputs at the same instant, found from what a component is made of.

`found` answers for a class: from the sparsity of a plant's expressions, and from the Python text of
everything else (`interpreter`). `checked` tries what a declaration narrows, looks for ports that a
mistyped name leaves out, and remembers the answers by the hash of the code.
"""
