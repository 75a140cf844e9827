"""CP: the crease pattern as one line of text for each edge, for programs that fold it.

Input: a ``FoldedPattern``; output: ``type x1 y1 x2 y2`` for each edge, in mm, y pointing down; type 1 is the border, 2
a mountain, 3 a valley. ORIPA, Orihime and Flat-Folder (io.js, CP_2_L) read it.
"""

from __future__ import annotations

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from .edges import TYPES, edge_lines


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as a .cp file; nothing in it depends on the profile."""
    lines = (f"{TYPES[letter]} {a!r} {b!r} {c!r} {d!r}\n" for letter, a, b, c, d in edge_lines(pattern))
    return "".join(lines).encode("ascii")
