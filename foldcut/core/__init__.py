"""What every other package builds on: arrays, the data between stages, errors and units of length.

- ``arrays``: array types, functions that make arrays read-only, and ``Ragged``, the lists of lists.
- ``model``: the data that passes between stages, from ``Shape`` to ``FoldedPattern`` and ``Finding``.
- ``errors``: every error that foldcut raises on purpose.
- ``signals``: signals that wait while something is done that must not be broken off.
- ``units``: millimetres per unit, and lengths as users write them.
"""
