"""Outlines to begin the search with: a drawing's loops and a tolerance -> polygons within it that promise few folds.

An outline folds with few folds if an even number of ridges meets in each node of its straight skeleton. So it is where
both edges of a strip, of paper inside or outside, have the same bends at the same places: then four sides are equally
far from the middle of a disk between each two bends. ``starts`` makes outlines of several kinds (``outlines.KINDS``),
all by dividing the drawn loops into the fewest pieces that are straight within the tolerance:

- every loop for itself, with lines of any direction (``fitting``), of few directions (``directions``), or tangents of
  one circle in each bend (``arcs``), with straight sides of the drawing kept where they are or not;
- both edges of a strip (``strips``) together, as tangents of common disks (``disks``), or one edge first and then the
  other so that it follows it (``following``), the first being the inner edge of each bend, perhaps (``bends``);
- circles as regular polygons (``circles``).

Mirror axes that are given are kept exactly: half of the drawing is fitted, or a quarter, and mirrored (``chains``).
"""

from foldcut.redraw.starts.chains import Axis
from foldcut.redraw.starts.outlines import Start, all_starts, starts

__all__ = ["Axis", "Start", "all_starts", "starts"]
