"""The straight skeleton of any planar graph.

``graph`` is the input and its sides; ``wavefront`` moves the wavefront, in the tables of ``tables``, and ``decimals``
does so with more digits; ``skeleton`` calls them in a ``frame`` and returns a ``StraightSkeleton``. Such a skeleton can
follow its points (``moving``, with ``motion``), be made again near a change only (``update``), and tell how its nodes
move with the points (``derivatives``).
"""

from foldcut.geometry.straight_skeleton.graph import Graph, graph_of
from foldcut.geometry.straight_skeleton.skeleton import Solver, StraightSkeleton, straight_skeleton

__all__ = ["Graph", "Solver", "StraightSkeleton", "graph_of", "straight_skeleton"]
