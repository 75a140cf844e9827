"""Straight skeletons by CGAL, for comparison: ``compas_cgal`` is part of the extra ``test`` and of nothing else.

CGAL takes one polygon with holes at a time. So graphs have to consist of loops that do not touch; each face of the
plane is given by itself, the unbounded one within a square frame far away. What CGAL cannot do is said in words. It may
crash or never return, so it runs in a process of its own: ``python -m support.cgal`` reads a list of polygons with
holes, as JSON, and writes one line for each.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
import shapely
from scipy.spatial import KDTree

from foldcut.core.arrays import Floats
from foldcut.geometry.straight_skeleton import StraightSkeleton
from support.places import TESTS
from support.planar_graphs import Edges, Graph
from support.skeleton_judge import Case

FRAME = 8.0
"""How far from the middle of the drawing the frame is, in sizes of the drawing."""

CLOSE = 1e-6
"""How far apart a node of ours and one of CGAL's may be, in sizes of the drawing."""

SECONDS = 20
"""How long CGAL may take for one polygon."""

NEARLY_PARALLEL = 1e-7
"""The sine of an angle between sides below which CGAL is not exact."""

Polygon = list[Floats]
"""The outline, counter-clockwise, and the holes, clockwise."""


def cgal_nodes(graphs: Sequence[Graph]) -> list[list[Floats] | str]:
    """Return for each graph the nodes ``(k, 2)`` in each of its regions, as ``regions`` has them; or what failed."""
    rows = [[[loop.tolist() for loop in polygon] for polygon in regions(*graph)] for graph in graphs]
    answers: list[list[Floats] | str] = []
    flat = [(k, polygon) for k, polygons in enumerate(rows) for polygon in polygons]
    found: list[Floats | str] = []
    while len(found) < len(flat):
        found += _answers([polygon for _, polygon in flat[len(found) :]])
    for k in range(len(graphs)):
        ours = [answer for (graph, _), answer in zip(flat, found, strict=True) if graph == k]
        failures = [answer for answer in ours if isinstance(answer, str)]
        answers.append(failures[0] if failures else [answer for answer in ours if not isinstance(answer, str)])
    return answers


def _answers(polygons: list[list[list[list[float]]]]) -> list[Floats | str]:
    """Return CGAL's nodes for polygons, one after the other, until it crashes; that is the last answer then."""
    program = [sys.executable, "-m", "support.cgal"]
    done = subprocess.run(program, input=json.dumps(polygons), capture_output=True, text=True, check=False, cwd=TESTS)
    answers: list[Floats | str] = []
    for line in done.stdout.splitlines():
        answer = json.loads(line)
        answers.append(answer if isinstance(answer, str) else np.array(answer).reshape(-1, 2))
    if len(answers) < len(polygons):
        said = done.stderr.strip().splitlines()
        answers.append(f"CGAL ended with status {done.returncode}: {said[-1] if said else ''}")
    return answers


def regions(points: Floats, edges: Edges) -> Iterator[Polygon]:
    """Yield the faces of the plane around loops: the unbounded one with a frame, then the inside of each loop."""
    loops = [points[loop] for loop in loops_of(edges)]
    loops = [loop if shapely.is_ccw(shapely.linearrings(loop)) else loop[::-1] for loop in loops]
    areas = np.array([shapely.Polygon(loop).area for loop in loops])
    inside = [
        [k for k in np.argsort(areas).tolist() if k != n and shapely.Polygon(loops[k]).contains(shapely.Point(loop[0]))]
        for n, loop in enumerate(loops)
    ]
    low, high = points.min(axis=0), points.max(axis=0)
    half = FRAME * float(np.hypot(*(high - low)))
    frame = (low + high) / 2 + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for outer in range(-1, len(loops)):
        holes = [loop[::-1] for loop, around in zip(loops, inside, strict=True) if [*around, -1][0] == outer]
        yield [loops[outer] if outer >= 0 else frame, *holes]


def loops_of(edges: Edges) -> list[list[int]]:
    """Return the loops that a graph consists of, as rows of points; raise ``ValueError`` if there is anything else."""
    at: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        at.setdefault(a, []).append(b)
        at.setdefault(b, []).append(a)
    if any(len(others) != 2 for others in at.values()):
        raise ValueError("the graph has points where not two edges meet")
    loops, done = [], set()
    for first in at:
        loop: list[int] = []
        following: int | None = first
        while following is not None and following not in done:
            loop.append(following)
            done.add(following)
            following = next((k for k in at[following] if k not in done), None)
        if loop:
            loops.append(loop)
    return loops


def differences(skeleton: StraightSkeleton, nodes: list[Floats]) -> list[str]:
    """Return where a skeleton differs from CGAL's nodes, in words.

    Compared are nodes that neither the frame nor a node of nearly parallel sides is earlier than: where such sides meet
    CGAL solves equations that are nearly the same, so it is wrong there. Exactly parallel sides are no reason.
    """
    case = Case(skeleton)
    close = CLOSE * case.size
    numbers = np.arange(case.count, len(skeleton.nodes))
    doubtful = [skeleton.time[node] for node in numbers.tolist() if has_nearly_parallel_sides(case, node)]
    early = numbers[skeleton.time[numbers] < min([_frame_is_met(case), *doubtful]) - close]
    theirs, inner = np.concatenate(nodes), np.concatenate([skeleton.graph.points[:0], *nodes[1:]])
    away = KDTree(theirs).query(skeleton.nodes[early])[0] - case.spread[early]
    found = [f"CGAL does not have {case.node(int(k))}" for k in early[away > close]]
    away = KDTree(skeleton.nodes).query(inner)[0] if len(inner) and not doubtful else np.zeros(len(inner))
    found += [f"CGAL has a node at ({x:.9g}, {y:.9g})" for x, y in inner[away > close].tolist()]
    return found


def has_nearly_parallel_sides(case: Case, node: int) -> bool:
    """Return whether two sides of a node are parallel within rounding, and not exactly."""
    sides = combinations(case.skeleton.node_sides(node).tolist(), 2)
    return any(
        abs(case.along[one] @ case.normal[other]) < NEARLY_PARALLEL and case.turn(one, other) != 0
        for one, other in sides
    )


def _frame_is_met(case: Case) -> float:
    """Return the first time when the wavefront is as far from the frame as that has moved."""
    skeleton = case.skeleton
    half = FRAME * case.size
    start, velocity = skeleton.arcs[:, 0], skeleton.arc_velocity
    end = np.where(skeleton.arcs[:, 1] < 0, np.inf, skeleton.time[skeleton.arcs[:, 1]])
    met = np.inf
    for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        gap = half - (skeleton.nodes[start] - case.middle) @ (x, y) - skeleton.time[start]
        rate = 1 + velocity @ (x, y)
        with np.errstate(all="ignore"):
            time = skeleton.time[start] + np.where(rate > 0, np.maximum(gap, 0) / rate, np.inf)
        met = min(met, float(np.where(time <= end, time, np.inf).min()))
    return met


def _nodes(polygon: list[list[list[float]]]) -> list[list[float]] | str:
    from compas_cgal import _straight_skeleton_2 as cgal
    from compas_cgal import _types_std  # noqa: F401  # the types that it returns

    flat = [np.column_stack([loop, np.zeros(len(loop))]) for loop in polygon]
    try:
        points, *_ = cgal.create_interior_straight_skeleton_with_holes(flat[0], flat[1:])
    except (RuntimeError, ValueError) as error:
        return f"CGAL says: {error}"
    if not np.isfinite(points).all():
        return "CGAL has a node at infinity"
    found: list[list[float]] = points[:, :2].tolist()
    return found


if __name__ == "__main__":
    for polygon in json.load(sys.stdin):
        signal.alarm(SECONDS)
        print(json.dumps(_nodes(polygon)), flush=True)
