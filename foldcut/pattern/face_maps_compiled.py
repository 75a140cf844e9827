"""Face maps with compiled code: a tree of faces across long edges, and each face folded over its edge of the tree.

It imports numba, so it is imported only for many faces.
"""

from __future__ import annotations

import math

import numpy as np

from foldcut.core.compiled import compiler

__all__ = ["fold", "tree_of_faces"]

njit = compiler()

FINENESS = 2.0
"""Faces whose distances differ by less than a factor of two to the power of 1 / FINENESS are reached in any order."""


@njit(cache=True, nogil=True)
def fold(left, right, edges, coords, folds, turn, shift, up, tiny):
    """Write every face's map to ``turn``, ``shift`` ``(f, 2)`` and ``up``, which hold the map of face 0 at first.

    Edge e lies between the faces ``left[e]`` and ``right[e]`` (-1 for none) and is folded if ``folds[e]``; no edge
    counts as shorter than ``tiny``.
    """
    via = tree_of_faces(left, right, edges, coords, len(up), tiny)
    done = np.zeros(len(up), dtype=np.bool_)
    waiting = np.empty(len(up), dtype=np.int32)
    for face in range(len(up)):
        count, here = 0, face
        while via[here] >= 0 and not done[here]:
            waiting[count] = here
            count += 1
            here = left[via[here]] + right[via[here]] - here
        while count > 0:
            count -= 1
            child = waiting[count]
            _fold_over(via[child], child, here, edges, coords, folds, turn, shift, up, tiny)
            done[child] = True
            here = child


@njit(cache=True, nogil=True)
def tree_of_faces(left, right, edges, coords, faces, tiny):
    """Return the edge that leads from each face toward face 0, -1 for none: nearly the least sum of 1 / length.

    This is Dijkstra's algorithm with buckets: faces at about the same distance are not sorted.
    """
    first = np.zeros(faces + 2, dtype=np.int32)
    for edge in range(len(left)):
        if left[edge] >= 0 and right[edge] >= 0:
            first[left[edge] + 2] += 1
            first[right[edge] + 2] += 1
    for face in range(faces):
        first[face + 2] += first[face + 1]
    beside = np.empty((first[faces + 1], 2), dtype=np.int32)  # edges, and the faces beyond them
    price = np.empty(len(beside), dtype=np.float32)
    for edge in range(len(left)):
        if left[edge] >= 0 and right[edge] >= 0:
            tail, head = edges[edge, 0], edges[edge, 1]
            length = np.hypot(coords[head, 0] - coords[tail, 0], coords[head, 1] - coords[tail, 1])
            for face in (left[edge], right[edge]):
                place = first[face + 1]
                beside[place, 0], beside[place, 1] = edge, left[edge] + right[edge] - face
                price[place] = min(1 / max(length, tiny), 1e30)  # single precision ends at 3e38
                first[face + 1] += 1
    distance = np.full(faces, np.inf)  # negative for faces that are done
    via = np.full(faces, -1, dtype=np.int32)
    last = np.full(int(FINENESS * 2100), -1, dtype=np.int32)  # the last entry of each bucket
    before, waits = np.empty(faces, dtype=np.int32), np.empty(faces, dtype=np.int32)
    distance[0], before[0], waits[0], last[0] = 0.0, -1, 0, 0
    entries = 1
    free = -1  # the first of the entries that can be used again
    bucket, end = 0, 1
    while bucket < end:
        entry = last[bucket]
        if entry < 0:
            bucket += 1
            continue
        here = waits[entry]
        last[bucket] = before[entry]
        before[entry] = free
        free = entry
        far = distance[here]
        if far < 0:
            continue
        distance[here] = -1.0
        for number in range(first[here], first[here + 1]):
            other, through = beside[number, 1], far + price[number]
            if through < distance[other]:
                distance[other], via[other] = through, beside[number, 0]
                place = min(max(int(FINENESS * math.log2(1.0 + through)), bucket), len(last) - 1)
                if free >= 0:
                    entry = free
                    free = before[entry]
                else:
                    if entries == len(waits):
                        before, waits = np.append(before, before), np.append(waits, waits)
                    entry = entries
                    entries += 1
                waits[entry], before[entry], last[place] = other, last[place], entry
                end = max(end, place + 1)
    return via


@njit(cache=True, nogil=True)
def _fold_over(edge, face, before, edges, coords, folds, turn, shift, up, tiny):
    """Fold a face over the edge to the face before it."""
    (one, other), (dx, dy) = (turn[before, 0], turn[before, 1]), (shift[before, 0], shift[before, 1])
    if not folds[edge]:
        turn[face, 0], turn[face, 1], shift[face, 0], shift[face, 1], up[face] = one, other, dx, dy, up[before]
        return
    tail, head = edges[edge, 0], edges[edge, 1]
    x, y = coords[tail, 0], coords[tail, 1]
    along_x, along_y = coords[head, 0] - x, coords[head, 1] - y
    length = np.hypot(along_x, along_y)
    if length > tiny:
        along_x, along_y = along_x / length, along_y / length
    else:
        along_x, along_y = 1.0, 0.0
    # the reflection is z -> mirror * conj(z) + offset
    mirror_x, mirror_y = along_x * along_x - along_y * along_y, 2 * along_x * along_y
    offset_x, offset_y = x - (mirror_x * x + mirror_y * y), y - (mirror_y * x - mirror_x * y)
    if not up[before]:
        mirror_y, offset_y = -mirror_y, -offset_y
    turned_x, turned_y = one * mirror_x - other * mirror_y, one * mirror_y + other * mirror_x
    size = np.hypot(turned_x, turned_y)
    turn[face, 0], turn[face, 1] = turned_x / size, turned_y / size
    shift[face, 0] = one * offset_x - other * offset_y + dx
    shift[face, 1] = one * offset_y + other * offset_x + dy
    up[face] = not up[before]
