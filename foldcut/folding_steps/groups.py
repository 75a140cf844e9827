"""The creases of a collapse, divided into groups that a person can press one after another: inner molecules first."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Indices, Ints, index_array
from foldcut.core.model import FoldedPattern, Region

__all__ = ["LEAST_GROUP", "MOST_GROUPS", "groups_of"]

LEAST_GROUP = 12
"""The least number of creases in a group: smaller groups are joined."""

MOST_GROUPS = 8
"""The greatest number of groups, as nearly as that can be: groups are joined to keep to it."""

ALONG = (0.02, 0.5, 0.98)
"""A crease reaches into a region if a point at one of these shares of its length is in the region."""


def groups_of(pattern: FoldedPattern, edges: Indices) -> tuple[Ints, ...]:
    """Divide creases by the regions that they reach into; what lies in a region or hangs on it comes before it.

    If the pattern's regions are not known, the longest creases come first. Groups are joined until there are few.
    """
    ends = pattern.creases.vertices_coords[pattern.creases.edges_vertices[edges]]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    key = _places_in_tree(pattern.regions, ends) if pattern.regions else np.argsort(np.argsort(-length, kind="stable"))
    order = np.lexsort((-length, key))
    size = max(LEAST_GROUP, math.ceil(len(edges) / MOST_GROUPS))
    groups: list[list[int]] = []
    for at, before in zip(order.tolist(), [-1, *order.tolist()], strict=False):
        if not groups or (len(groups[-1]) >= size and key[at] != key[before]):
            groups.append([])
        groups[-1].append(int(edges[at]))
    return tuple(index_array(sorted(group)) for group in groups)


def _places_in_tree(regions: Sequence[Region], ends: Floats) -> Indices:
    """Return for each crease the place of its smallest region in the tree of regions, children first, ``(n,)``."""
    owned = [(outline, number) for number, region in enumerate(regions) for outline in region.outlines]
    owned = [(outline, number) for outline, number in owned if len(outline) > 2]
    polygons = np.array([shapely.Polygon(outline) for outline, _ in owned])
    largest_first = np.argsort(-shapely.area(polygons), kind="stable")
    owner = np.array([number for _, number in owned])[largest_first]
    places = np.concatenate([ends[:, 0] * (1 - share) + ends[:, 1] * share for share in ALONG])
    polygon, place = shapely.STRtree(shapely.points(places)).query(polygons[largest_first], predicate="intersects")
    children: list[list[int]] = [[] for _ in regions]
    todo: list[int] = []
    for number, region in enumerate(regions):
        (children[region.parent] if region.parent >= 0 else todo).append(number)
    preorder = []
    while todo:
        preorder.append(todo.pop())
        todo += children[preorder[-1]]
    rank = np.empty(len(regions), dtype=np.intp)
    rank[preorder[::-1]] = np.arange(len(regions))
    found = np.full(len(ends), -1)
    np.maximum.at(found, place % len(ends), polygon)
    return np.where(found < 0, len(regions), rank[owner[found]])
