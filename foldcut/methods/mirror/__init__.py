"""Fold a drawing's mirror axes first, and then all layers at once.

``halves`` cuts the drawing at the axes, ``search`` folds the halves, and ``unfold`` makes the whole pattern.
"""
