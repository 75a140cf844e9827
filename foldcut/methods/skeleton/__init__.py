"""Fold any loops with few creases: along the straight skeleton and perpendiculars (Demaine, Demaine and Lubiw 1999).

The stages in order: ``snap`` moves corners by hairs (with ``move_corners``), ``skeleton_faces``, ``perpendiculars``,
``choices`` of those to fold, ``facets``, ``layer_order``; ``search`` makes one ``trial`` after the other within its
``budget``.
"""
