"""What others take for the same sheet with the same loop: the bench's yardsticks.

- ``scipy.spatial.Delaunay`` of the centres of the disks: the floor for touching that many points.
- PyPI ``triangle`` (Shewchuk's Triangle: Ruppert's refinement, no angle under 20 degrees), bounded in area so that
  there are as many triangles as the pattern has faces.
- ``shapely.constrained_delaunay_triangles``, which adds no points: the edges are divided until there are as many.
- PyPI ``py-straight-skeleton`` and ``shapely-polyskel``: the straight skeleton of the loop and of the sheet around it;
  neither perpendiculars nor layers. One face for each side is what there must be, and they must fill the sheet.

The last two packages and ``triangle`` are the extra ``bench``. Triangle may not be sold without its author's leave,
so nothing but the bench uses it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import shapely
from items import Item, Subject

NEAR = 0.02
"""How near the number of triangles has to come to the number of faces."""


def _delaunay(subject: Subject) -> Callable[[], Any]:
    from scipy.spatial import Delaunay

    return partial(Delaunay, subject.centres)


def matched(count: Callable[[float], int], wanted: int, size: float) -> float:
    """Return the largest size of a cell for which there are about as many cells as are wanted."""
    for _ in range(8):
        found = count(size)
        if abs(found / wanted - 1) < NEAR:
            break
        size *= found / wanted
    return size


def _triangle(subject: Subject) -> Callable[[], Any]:
    import triangle

    loop, corners = subject.pattern.shape.loops[0], subject.pattern.sheet.corners
    around = [first + np.column_stack([np.arange(n), (np.arange(n) + 1) % n]) for first, n in _spans(loop, corners)]
    plan = {"vertices": np.concatenate([loop, corners]), "segments": np.concatenate(around)}

    def mesh(area: float) -> np.ndarray:
        triangles: np.ndarray = triangle.triangulate(plan, f"pqa{area:.12f}")["triangles"]
        return triangles

    sheet = subject.pattern.sheet
    area = matched(lambda area: len(mesh(area)), subject.faces, 1.6 * sheet.width * sheet.height / subject.faces)
    return partial(mesh, area)


def _spans(*rings: np.ndarray) -> list[tuple[int, int]]:
    """Return where each ring's points begin, and how many they are."""
    counts = [len(ring) for ring in rings]
    return list(zip(np.cumsum([0, *counts[:-1]]).tolist(), counts, strict=True))


def _parts(subject: Subject) -> tuple[shapely.Polygon, shapely.Polygon]:
    """Return the inside of the loop and the sheet around it."""
    loop = subject.pattern.shape.loops[0]
    return shapely.Polygon(loop), shapely.Polygon(subject.pattern.sheet.corners, [loop])


def _constrained(subject: Subject) -> Callable[[], Any]:
    parts = _parts(subject)

    def divided(length: float) -> list[Any]:
        return [shapely.segmentize(part, length) for part in parts]

    def count(length: float) -> int:
        # a polygon of n points and h holes has n + 2 h - 2 triangles; shapely repeats the first point of a ring
        return sum(
            shapely.get_num_coordinates(part) + shapely.get_num_interior_rings(part) - 3 for part in divided(length)
        )

    around = sum(part.length for part in parts)
    meshed = divided(matched(count, subject.faces, around / subject.faces))
    return lambda: [shapely.constrained_delaunay_triangles(part) for part in meshed]


def py_straight_skeleton(parts: Sequence[shapely.Polygon]) -> Callable[[], Any]:
    """Return what makes the straight skeletons of polygons by PyPI's ``py-straight-skeleton``."""
    from py_straight_skeleton import compute_skeleton

    rings = [_rings(part) for part in parts]
    return lambda: [(compute_skeleton(outer, holes), outer, holes) for outer, holes in rings]


def _rings(part: shapely.Polygon) -> tuple[list[list[float]], list[list[list[float]]]]:
    """Return the outer ring counter-clockwise and the holes clockwise, without the first point at the end."""
    part = shapely.orient_polygons(part, exterior_cw=False)
    return [list(p) for p in part.exterior.coords[:-1]], [
        [list(p) for p in ring.coords[:-1]] for ring in part.interiors
    ]


def check_py_straight_skeleton(results: list[Any]) -> dict[str, Any]:
    """Count the faces; raise ValueError unless there is one for each side and they fill the polygons."""
    faces: list[shapely.Polygon] = []
    sides, area = 0, 0.0
    for skeleton, outer, holes in results:
        at = np.array([[node.position.x, node.position.y] for node in skeleton.nodes])
        faces += [shapely.Polygon(at[face]) for face in skeleton.get_faces()]
        sides += len(outer) + sum(map(len, holes))
        area += shapely.Polygon(outer, holes).area
    return _filled(faces, sides, area)


def polyskel(parts: Sequence[shapely.Polygon]) -> Callable[[], Any]:
    """Return what makes the straight skeletons of polygons by PyPI's ``shapely-polyskel``."""
    from shapely_polyskel import StraightSkeleton

    return lambda: [(StraightSkeleton(part), part) for part in parts]


def check_polyskel(results: list[Any]) -> dict[str, Any]:
    """Count the faces; raise ValueError unless there is one for each side and they fill the polygons."""
    faces: list[shapely.Polygon] = []
    sides, area = 0, 0.0
    for skeleton, part in results:
        arcs = [
            shapely.LineString([(tree.source.x, tree.source.y), (sink.x, sink.y)])
            for tree in skeleton.straight_skeleton
            for sink in tree.sinks
            if tree.source != sink
        ]
        cells = shapely.polygonize([shapely.union_all([*arcs, part.boundary])]).geoms
        faces += [cell for cell in cells if part.contains(cell.representative_point())]
        sides += shapely.get_num_coordinates(part) - 1 - len(part.interiors)
        area += part.area
    return _filled(faces, sides, area)


def _filled(faces: list[shapely.Polygon], sides: int, area: float) -> dict[str, Any]:
    """Say how many faces there are, and raise ValueError unless they are as many as sides and fill the area."""
    found = sum(face.area for face in faces)
    if len(faces) != sides or abs(found / area - 1) > 1e-6:
        raise ValueError(f"{len(faces):,} faces for {sides:,} sides, and {found / area:.6f} of the area")
    return {"faces": len(faces)}


DELAUNAY = Item("Delaunay", _delaunay, lambda mesh: {"triangles": len(mesh.simplices)}, limit=float("inf"))
YARDSTICKS = (
    DELAUNAY,
    Item("triangle", _triangle, lambda triangles: {"triangles": len(triangles)}, needs="triangle"),
    Item(
        "shapely constrained Delaunay",
        _constrained,
        lambda parts: {"triangles": sum(len(part.geoms) for part in parts)},
    ),
    Item(
        "py-straight-skeleton",
        lambda subject: py_straight_skeleton(_parts(subject)),
        check_py_straight_skeleton,
        needs="py_straight_skeleton",
    ),
    Item("shapely-polyskel", lambda subject: polyskel(_parts(subject)), check_polyskel, needs="shapely_polyskel"),
)
