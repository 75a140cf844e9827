"""Fold a drawing's mirror axes first, and then all layers at once.

``halves`` cuts the drawing at the axes, ``skeletal`` and ``search`` fold what is left of the sheet. ``unfold`` makes
the whole pattern of a half or a quarter, ``wedge`` that of a wedge.
"""
