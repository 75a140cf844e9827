"""STEP: the scored sheet, or the folded one, as one solid with plane faces, for CAD.

Input: a ``FoldedPattern`` and a ``Profile`` with ``solid``; output: STEP AP214, mm. The mesh of
``scored_sheet`` has the geometry already, exact to rounding; its triangles in one plane become one face, and faces
share edges and corners, so that nothing has to be cut or sewn. Needs the extra ``solids``.
"""

from __future__ import annotations

import io
from collections import defaultdict
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats, Numbers
from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from .folded_stack import solid_of
from .scored_sheet import corners_and_triangles, needs

FLAT_MM = (1e-6, 1e-8)
"""Triangles whose corners are this near to a plane lie in it; the second is tried if the first gives no valid solid."""

NEAR_MM = 1e-7
"""Open CASCADE takes corners further away for off their face's plane (``Precision::Confusion``)."""

Half = tuple[int, int]
"""A half-edge: the corners from which and to which it goes."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the sheet as a STEP file; errors as for ``solid_of``."""
    needs("build123d")
    from build123d import export_step

    solid = step_solid(pattern, profile)
    out = io.BytesIO()
    # curves on planes repeat what the planes say, and would be two thirds of the file
    export_step(solid, out, write_pcurves=False, timestamp="2000-01-01T00:00:00")
    return out.getvalue()


def step_solid(pattern: FoldedPattern, profile: Profile) -> Any:
    """Return the sheet as a ``build123d.Solid``; errors as for ``solid_of``."""
    scored = solid_of(pattern, profile)
    for flat in FLAT_MM:
        mesh = scored.simplify(flat).to_mesh64()
        solid = _valid_solid(*corners_and_triangles(mesh), np.asarray(mesh.face_id))
        if solid is not None:
            return solid
    points, triangles = corners_and_triangles(mesh)
    solid = _valid_solid(points, triangles, np.arange(len(triangles)))  # a single triangle is always plane
    if solid is None:
        raise FileFormatError("the sheet is no valid solid for STEP; try .stl, or other grooves")
    return solid


def _valid_solid(points: Floats, triangles: Numbers, plane: Numbers) -> Any:
    """Return the solid, or None if a face has no area, an edge no length, or Open CASCADE finds the solid invalid."""
    from build123d import Solid
    from OCP.StdFail import StdFail_NotDone

    faces = plane_faces(triangles, plane)
    places, normals = planes(points, faces)
    if not normals.any(axis=1).all() or max_off(points, faces, places, normals) > NEAR_MM:
        return None
    try:
        solid = Solid(Builder(points).solid(faces, places, normals))
    except StdFail_NotDone:  # the ends of an edge are nearer to each other than Open CASCADE's 1e-7 mm
        return None
    return solid if solid.is_valid else None


def plane_faces(triangles: Numbers, plane: Numbers) -> list[list[list[int]]]:
    """Join triangles, ``(t, 3)``, that are in the same plane, ``(t,)``; return the loops of corners of each face."""
    triangle: dict[Half, int] = {}
    opposite: dict[Half, int] = {}
    for at, (a, b, c) in enumerate(triangles.tolist()):
        for one, other, third in ((a, b, c), (b, c, a), (c, a, b)):
            triangle[one, other], opposite[one, other] = at, third
    planes = plane.tolist()

    def within(half: Half) -> int:
        return int(planes[triangle[half]])

    borders: dict[int, dict[Half, None]] = defaultdict(dict)
    for a, b in triangle:
        if within((b, a)) != within((a, b)):
            borders[within((a, b))][a, b] = None
    faces = []
    for number, left in borders.items():
        loops = []
        while left:
            half, loop = next(iter(left)), []
            while half in left:
                del left[half]
                loop.append(half[0])
                # turn about the end, through the face's triangles, to the next side
                end, third = half[1], opposite[half]
                while within((third, end)) == number:
                    third = opposite[third, end]
                half = end, third
            loops.append(loop)
        faces.append(loops)
    return faces


def planes(points: Floats, faces: list[list[list[int]]]) -> tuple[Floats, Floats]:
    """Return a place in the plane of each face, ``(f, 3)``, and its unit normal, or 0 for a face without area.

    The loops of each face are reordered in place so that its outer one comes first.
    """
    loops = [loop for face in faces for loop in face]
    counts = np.array([len(loop) for loop in loops])
    starts = np.cumsum(counts) - counts
    corners = points[np.concatenate(loops)]
    centres = np.add.reduceat(corners, starts) / counts[:, None]
    spokes = corners - np.repeat(corners[starts], counts, axis=0)
    # the last spoke of a loop is paired with the first of the next, which is 0, and so adds nothing
    turns = np.append(np.cross(spokes[:-1], spokes[1:]), np.zeros((1, 3)), axis=0)
    normals = np.add.reduceat(turns, starts)
    sizes = np.linalg.norm(normals, axis=1)
    first = 0
    chosen = np.empty(len(faces), dtype=np.int64)
    for number, face in enumerate(faces):
        outer = int(np.argmax(sizes[first : first + len(face)])) if len(face) > 1 else 0
        chosen[number] = first + outer
        face.insert(0, face.pop(outer))
        first += len(face)
    normals, sizes = normals[chosen], sizes[chosen]
    return centres[chosen], normals / np.where(sizes > 0, sizes, 1.0)[:, None]


def max_off(points: Floats, faces: list[list[list[int]]], places: Floats, normals: Floats) -> float:
    """Return the largest distance in mm between a corner and the plane of its face."""
    counts = [sum(map(len, face)) for face in faces]
    corners = points[[corner for face in faces for loop in face for corner in loop]]
    away = corners - np.repeat(places, counts, axis=0)
    return float(np.abs((away * np.repeat(normals, counts, axis=0)).sum(axis=1)).max())


class Builder:
    """Makes a solid of plane faces that share edges and corners, with Open CASCADE itself: build123d would sew them."""

    def __init__(self, points: Floats) -> None:
        self.points = points.tolist()
        self.corners: dict[int, Any] = {}
        self.edges: dict[Half, Any] = {}

    def solid(self, faces: list[list[list[int]]], places: Floats, normals: Floats) -> Any:
        """Return the solid that the faces enclose; the first loop of each is its outer one."""
        from OCP.BRep import BRep_Builder
        from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

        builder = BRep_Builder()
        shell, solid = TopoDS_Shell(), TopoDS_Solid()
        builder.MakeShell(shell)
        for loops, place, normal in zip(faces, places.tolist(), normals.tolist(), strict=True):
            builder.Add(shell, self._face(builder, loops, place, normal))
        shell.Closed(True)
        builder.MakeSolid(solid)
        builder.Add(solid, shell)
        return solid

    def _face(self, builder: Any, loops: list[list[int]], place: list[float], normal: list[float]) -> Any:
        from OCP.Geom import Geom_Plane
        from OCP.gp import gp_Dir, gp_Pnt
        from OCP.TopoDS import TopoDS_Face

        face = TopoDS_Face()
        builder.MakeFace(face, Geom_Plane(gp_Pnt(*place), gp_Dir(*normal)), NEAR_MM)
        for loop in loops:
            builder.Add(face, self._wire(loop))
        return face

    def _wire(self, loop: list[int]) -> Any:
        from OCP.BRep import BRep_Builder
        from OCP.TopoDS import TopoDS_Wire

        builder, wire = BRep_Builder(), TopoDS_Wire()
        builder.MakeWire(wire)
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
            builder.Add(wire, self._edge(a, b))
        wire.Closed(True)
        return wire

    def _edge(self, a: int, b: int) -> Any:
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

        key = min(a, b), max(a, b)
        if key not in self.edges:
            self.edges[key] = BRepBuilderAPI_MakeEdge(self._corner(key[0]), self._corner(key[1])).Edge()
        return self.edges[key] if a < b else self.edges[key].Reversed()

    def _corner(self, number: int) -> Any:
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
        from OCP.gp import gp_Pnt

        if number not in self.corners:
            self.corners[number] = BRepBuilderAPI_MakeVertex(gp_Pnt(*self.points[number])).Vertex()
        return self.corners[number]
