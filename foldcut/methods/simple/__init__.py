"""Simple folds: each goes along one straight line across the whole sheet as it lies, through all of its layers.

``drawing`` is the drawing on a sheet that is folded so, ``lines`` has the lines that are worth a fold, ``search`` looks
for a sequence of them, and ``stack`` folds paper along it. See docs/simple-folds.md.
"""
