"""What an outline costs to fold, without folding it: its ridges and perpendiculars away from the cheapest corridor.

A finished wavefront (``geometry.straight_skeleton``) -> counts, lengths and candidates in ``Work``.

The faces of the skeleton are kept as half-edges: half-edge h runs from ``tail[h]`` to ``head[h]`` with the face of side
``face[h]`` on its left, and ``twin[h]`` runs back. Every face is seen from its side: u is the distance along it. A
perpendicular is traced from half-edge to half-edge: in each face it goes from one chain straight to the other, so from
a half-edge along which u grows to one along which it falls, or the other way.

This file is run as it is, or compiled; nothing is allocated in it.
Source: Demaine, Demaine and Lubiw, "Folding and one straight cut suffice", 1999 (ridges and perpendiculars).
"""

from __future__ import annotations

from math import atan2, inf, sqrt

from foldcut.core.compiled import compiled_in
from foldcut.geometry.straight_skeleton.wavefront import ARCS as FRONT_ARCS
from foldcut.geometry.straight_skeleton.wavefront import NODES as FRONT_NODES

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

# kinds of half-edges
RIDGE, BASE, LEVEL = 0, 1, 2

# places in ``counts``
(
    NODES,
    HALVES,
    PATHS,
    SPOKES,
    CUTS,
    RIDGES,
    WAYS,
    MISSES,
    TAKEN,
    ENDLESS,
    LINES,
    STUCK,
    SHORT,
    DEGREES,
    POINTS,
    GROUPS,
    EXITS_X,
    EXITS_Y,
    LOOSE,
) = range(19)

# places in ``ints``: of the perpendicular that was walked last its end (-1 for the border), how many pieces it has, in
# which face the way back would begin, and how many folds it takes; the outline's corners; perpendiculars noted in all
END, PIECES, LAST_FACE, FOLDS, CORNERS, NOTED = range(6)

# places in ``numbers``
SHORTEST, PENALTY, COST = range(3)

# places in ``sizes``
(
    WIDTH,
    HEIGHT,
    SNAP,
    NEAR,
    LEAST_CREASE,
    ENDLESS_COST,
    REACH,
    SHORT_COST,
    SHORTER_COST,
    FOLDED_X,
    FOLDED_Y,
    LOOSE_COST,
) = range(12)

MOST_CROSSINGS = 30
"""A perpendicular that crosses more faces is given up."""

MOST_PARTIAL = 9
"""Of a perpendicular that does not end, so many crossings are looked at for nodes that it passes."""

FULL = -1
"""What a function returns when a table is too small."""


@inlined
def root_of(w, node):
    """Return the node that stands for all nodes joined with this one."""
    while w.root[node] != node:
        w.root[node] = w.root[w.root[node]]
        node = w.root[node]
    return node


@compiled
def gather(front, sides, faces, w, corners, flanks, scale, middle_x, middle_y):
    """Take nodes and faces from a wavefront that has come to its end; join nodes that are almost one."""
    near, snap = w.sizes[NEAR], w.sizes[SNAP]
    count = front.counts[FRONT_NODES]
    if count > len(w.x):
        return FULL
    w.counts[NODES] = count
    for node in range(count):
        it = front.nodes[node]
        w.x[node] = it.x * scale + middle_x
        w.y[node] = it.y * scale + middle_y
        w.root[node] = it.same_as
        w.degree[node] = 0
        w.at_node[node] = -1
        w.level_at[node] = -1
        w.spoke_at[node] = -1
    for number in range(front.counts[FRONT_ARCS]):
        arc = front.arcs[number]
        if arc.end < 0:
            continue
        a, b = root_of(w, arc.start), root_of(w, arc.end)
        if a != b and a >= corners and b >= corners:
            dx, dy = w.x[a] - w.x[b], w.y[a] - w.y[b]
            if dx * dx + dy * dy < near * near:
                if a > b:
                    a, b = b, a
                w.root[b] = a
    filled = 0
    mask = len(w.key) - 1
    for k in range(mask + 1):
        w.key[k] = -1
    for side in range(flanks):
        w.first[side] = filled
        begin, end = faces.sides[side].offset, faces.sides[side + 1].offset
        tail, head = sides.tail[side], sides.head[side]
        dx, dy = w.x[head] - w.x[tail], w.y[head] - w.y[tail]
        length = sqrt(dx * dx + dy * dy)
        w.ax[side], w.ay[side] = dx / length, dy / length
        w.sx[side], w.sy[side] = w.x[tail], w.y[tail]
        for k in range(begin, end):
            a = faces.items[k].value
            b = faces.items[k + 1].value if k + 1 < end else faces.items[begin].value
            if a < 0 or b < 0:
                continue
            a, b = root_of(w, a), root_of(w, b)
            if a == b:
                continue
            if filled >= len(w.tail):
                return FULL
            w.tail[filled], w.head[filled], w.face[filled] = a, b, side
            w.u0[filled] = (w.x[a] - w.sx[side]) * w.ax[side] + (w.y[a] - w.sy[side]) * w.ay[side]
            w.u1[filled] = (w.x[b] - w.sx[side]) * w.ax[side] + (w.y[b] - w.sy[side]) * w.ay[side]
            w.kind[filled] = BASE if a == tail and b == head else RIDGE
            w.twin[filled] = -1
            w.cut_at[filled] = -1
            w.next_at_node[filled] = w.at_node[a]
            w.at_node[a] = filled
            # find the twin, or wait for it
            wanted = b * count + a
            slot = (wanted * 2654435761) & mask
            found = False
            while w.key[slot] != -1:
                if w.key[slot] == wanted and w.twin[w.value[slot]] < 0:
                    other = w.value[slot]
                    w.twin[filled], w.twin[other] = other, filled
                    found = True
                    break
                slot = (slot + 1) & mask
            if not found:
                mine = a * count + b
                slot = (mine * 2654435761) & mask
                while w.key[slot] != -1:
                    slot = (slot + 1) & mask
                w.key[slot], w.value[slot] = mine, filled
            filled += 1
    w.first[flanks] = filled
    w.counts[HALVES] = filled
    for h in range(filled):
        twin = w.twin[h]
        if twin < 0 or w.kind[h] == BASE:
            continue
        one, other = w.face[h], w.face[twin]
        if w.ax[one] * w.ax[other] + w.ay[one] * w.ay[other] > 1 - 1e-12:
            away = (w.sx[other] - w.sx[one]) * -w.ay[one] + (w.sy[other] - w.sy[one]) * w.ax[one]
            if abs(away) < snap * 10:
                w.kind[h] = LEVEL
                w.level_at[w.tail[h]] = h
        if w.kind[h] == RIDGE:
            w.degree[w.tail[h]] += 1  # the twin counts the other end
    return 0


@inlined
def on_sheet(w, x, y):
    """Return whether a point is strictly on the sheet."""
    snap = w.sizes[SNAP]
    return snap < x < w.sizes[WIDTH] - snap and snap < y < w.sizes[HEIGHT] - snap


@inlined
def sign_of(w, h):
    """Return 1 if u grows along a half-edge, -1 if it falls, 0 if it stays."""
    du = w.u1[h] - w.u0[h]
    if du > w.sizes[SNAP]:
        return 1
    if du < -w.sizes[SNAP]:
        return -1
    return 0


@compiled
def way_in(w, h):
    """Return which way the perpendicular from the tail of a half-edge runs in its face: 1 up, -1 down, 0 not at all."""
    face, node = w.face[h], w.tail[h]
    after = sign_of(w, h)
    if after == 0:
        return 0
    before = 0
    for k in range(w.first[face], w.first[face + 1]):
        if w.head[k] == node:
            before = sign_of(w, k)
            if before == after:
                return after
    return 0


@compiled
def cross(w, face, u, way, out):
    """Follow a perpendicular through a face.

    Returns the half-edge by which it leaves, or -1 - node if it comes to one, or ``None`` as -(1 << 40); ``out`` gets
    the place.
    """
    snap = w.sizes[SNAP]
    for h in range(w.first[face], w.first[face + 1]):
        if sign_of(w, h) != -way:
            continue
        low, high = (w.u1[h], w.u0[h]) if way > 0 else (w.u0[h], w.u1[h])
        if low - snap <= u <= high + snap:
            a, b = w.tail[h], w.head[h]
            if abs(u - w.u0[h]) <= snap:
                out[0], out[1] = w.x[a], w.y[a]
                return -1 - a
            if abs(u - w.u1[h]) <= snap:
                out[0], out[1] = w.x[b], w.y[b]
                return -1 - b
            part = (u - w.u0[h]) / (w.u1[h] - w.u0[h])
            out[0] = w.x[a] + part * (w.x[b] - w.x[a])
            out[1] = w.y[a] + part * (w.y[b] - w.y[a])
            return h
    return -(1 << 40)


@compiled
def walk(w, start, mode, path):
    """Follow the perpendicular from the tail of half-edge ``start``; ``mode`` says what is noted.

    0: nothing; returns whether it ends, and leaves its end, pieces, last face and folds in ``ints``.
    1: it is folded: its pieces are counted and measured, and where it cuts ridges.
    2: what it passes by is noted, whether it ends or not.
    """
    way = way_in(w, start)
    if way == 0 and w.kind[start] != LEVEL:
        return False
    snap = w.sizes[SNAP]
    node, face = w.tail[start], w.face[start]
    u = w.u0[start]
    x, y = w.x[node], w.y[node]
    begin_x, begin_y = x, y
    pieces = 0
    lines = 0
    straight_on = False
    w.ints[LAST_FACE] = -1
    if mode == 0:
        add_point(w, x, y)
    if mode == 2 or mode == 1:
        w.way_first[path] = w.counts[WAYS]
    for crossing in range(MOST_CROSSINGS):
        if mode == 2 and crossing >= MOST_PARTIAL:
            return False
        if mode > 0 and (crossing > 0 or w.kind[start] != LEVEL):
            if w.counts[WAYS] >= len(w.way):
                return False
            w.way[w.counts[WAYS]] = face
            w.counts[WAYS] += 1
            if mode == 2 or crossing < 10:
                note_misses(w, path, crossing, face, u, node)
        if crossing == 0 and w.kind[start] == LEVEL:  # along the line between two faces that are one
            h = -1 - w.head[start]
            w.place[0], w.place[1] = w.x[w.head[start]], w.y[w.head[start]]
        else:
            h = cross(w, face, u, way, w.place)
        if h == -(1 << 40):
            return False
        to_x, to_y = w.place[0], w.place[1]
        if crossing == 0 and (to_x - x) * (to_x - x) + (to_y - y) * (to_y - y) < snap * snap:
            return False
        ends_outside = not on_sheet(w, to_x, to_y)
        if ends_outside:
            part = 1.0
            dx, dy = to_x - x, to_y - y
            if dx > 0:
                part = min(part, (w.sizes[WIDTH] - x) / dx)
            elif dx < 0:
                part = min(part, -x / dx)
            if dy > 0:
                part = min(part, (w.sizes[HEIGHT] - y) / dy)
            elif dy < 0:
                part = min(part, -y / dy)
            to_x, to_y = x + part * dx, y + part * dy
        beyond = -1
        if h < 0 and not ends_outside:
            beyond = beyond_straight_ridge(w, -1 - h, face)
        is_end = ends_outside or (h < 0 and beyond < 0)
        if mode == 0:
            add_point(w, to_x, to_y)
        if not is_end and (w.kind[h] == BASE or w.kind[h] == LEVEL):
            pass  # it goes straight on
        else:
            pieces += 1
            if not straight_on:
                lines += 1
            if mode == 1:
                add_length(w, sqrt((to_x - begin_x) * (to_x - begin_x) + (to_y - begin_y) * (to_y - begin_y)))
                if pieces == 1:
                    add_spoke(w, node, to_x - begin_x, to_y - begin_y)
                if is_end and not ends_outside:
                    add_spoke(w, -1 - h, begin_x - to_x, begin_y - to_y)
                elif not ends_outside and h >= 0:
                    add_cut(w, h, to_x, to_y)
                if ends_outside:
                    add_exit(w, to_x, to_y)
            begin_x, begin_y = to_x, to_y
        if is_end:
            w.ints[END] = -1 if ends_outside else -1 - h
            w.ints[PIECES] = pieces
            w.ints[FOLDS] = lines
            if not ends_outside:
                # along the line between two faces the way back begins in the other one
                w.ints[LAST_FACE] = w.face[w.twin[start]] if crossing == 0 and w.kind[start] == LEVEL else face
            return True
        twin = beyond if h < 0 else w.twin[h]
        if twin < 0:
            return False
        following = w.face[twin]
        if h < 0 or w.kind[h] == RIDGE:
            straight_on = w.ax[face] * w.ax[following] + w.ay[face] * w.ay[following] < -1 + 1e-12
        way = way_in(w, twin) if h < 0 else sign_of(w, twin)
        if way == 0:
            return False
        face = following
        u = (to_x - w.sx[face]) * w.ax[face] + (to_y - w.sy[face]) * w.ay[face]
        x, y = to_x, to_y
    return False


@compiled
def beyond_straight_ridge(w, node, face):
    """Return the half-edge from a node into the face beyond it, where two faces are one and it is no node; or -1."""
    if w.level_at[node] < 0 or w.degree[node] != 2:
        return -1
    h = w.at_node[node]
    while h >= 0:
        other = w.face[h]
        if other != face and way_in(w, h) != 0 and w.ax[face] * w.ax[other] + w.ay[face] * w.ay[other] < 1 - 1e-12:
            return h
        h = w.next_at_node[h]
    return -1


@compiled
def note_misses(w, path, crossing, face, u, start):
    """Note the nodes of a face that a perpendicular nearly comes to."""
    reach = w.sizes[REACH]
    snap = w.sizes[SNAP]
    for h in range(w.first[face], w.first[face + 1]):
        node = w.tail[h]
        if node < w.ints[CORNERS] or node == start or not on_sheet(w, w.x[node], w.y[node]):
            continue
        miss = abs(w.u0[h] - u)
        if snap < miss < reach and w.counts[MISSES] < len(w.miss):
            k = w.counts[MISSES]
            w.miss[k] = miss
            w.miss_path[k], w.miss_step[k], w.miss_node[k] = path, crossing, node
            w.counts[MISSES] += 1


@inlined
def add_point(w, x, y):
    """Add a point to the perpendicular that is traced."""
    k = w.counts[POINTS]
    if k < len(w.point_x):
        w.point_x[k], w.point_y[k] = x, y
        w.counts[POINTS] += 1


@inlined
def add_length(w, length):
    """Take note of a crease's length."""
    if length < w.numbers[SHORTEST]:
        w.numbers[SHORTEST] = length
    if length < w.sizes[LEAST_CREASE]:
        w.numbers[PENALTY] += 1 - length / w.sizes[LEAST_CREASE]
        w.counts[SHORT] += 1


@compiled
def add_spoke(w, node, dx, dy):
    """Add a crease that begins at a node, and count down the lines if it goes straight on beyond it."""
    k = w.counts[SPOKES]
    if k >= len(w.spoke_x):
        return
    length = sqrt(dx * dx + dy * dy)
    dx, dy = dx / length, dy / length
    other = w.spoke_at[node]
    while other >= 0:
        if dx * w.spoke_x[other] + dy * w.spoke_y[other] < -1 + 1e-11:
            w.counts[LINES] -= 1
            break
        other = w.spoke_next[other]
    w.spoke_x[k], w.spoke_y[k] = dx, dy
    w.spoke_next[k] = w.spoke_at[node]
    w.spoke_at[node] = k
    w.counts[SPOKES] += 1


@compiled
def add_cut(w, h, x, y):
    """Note that a perpendicular cuts a ridge, sorted by how far along the ridge it does so."""
    if w.twin[h] < h:
        h = w.twin[h]
    k = w.counts[CUTS]
    if k >= len(w.cut_part):
        return
    a, b = w.tail[h], w.head[h]
    dx, dy = w.x[b] - w.x[a], w.y[b] - w.y[a]
    w.cut_part[k] = ((x - w.x[a]) * dx + (y - w.y[a]) * dy) / (dx * dx + dy * dy)
    before, at = -1, w.cut_at[h]
    while at >= 0 and w.cut_part[at] < w.cut_part[k]:
        before, at = at, w.cut_next[at]
    w.cut_next[k] = at
    if before < 0:
        w.cut_at[h] = k
    else:
        w.cut_next[before] = k
    w.counts[CUTS] += 1


@inlined
def is_continued(w, node, x, y):
    """Return whether a ridge goes on beyond a node straight away from a point."""
    dx, dy = w.x[node] - x, w.y[node] - y
    h = w.at_node[node]
    while h >= 0:
        if w.kind[h] == RIDGE:
            ex, ey = w.x[w.head[h]] - w.x[node], w.y[w.head[h]] - w.y[node]
            if dx * ex + dy * ey > (1 - 1e-11) * sqrt((dx * dx + dy * dy) * (ex * ex + ey * ey)):
                return True
        h = w.next_at_node[h]
    return False


@compiled
def saved(w, k):
    """Return how many lines a perpendicular saves that was traced just now: at its ends it may be one with a ridge."""
    first, last = w.path_point[k], w.counts[POINTS] - 1
    if last <= first or last + 1 >= len(w.point_x):
        return 0
    count = 0
    if is_continued(w, w.path_start[k], w.point_x[first + 1], w.point_y[first + 1]):
        count += 1
    if w.path_end[k] >= 0 and is_continued(w, w.path_end[k], w.point_x[last - 1], w.point_y[last - 1]):
        count += 1
    return count


@compiled
def find_paths(w, corners):
    """Trace the perpendiculars of all nodes, counter-clockwise around each.

    ``path_next`` is the next one around the same node. One that ends at another node is there twice, once from each
    end; they are each other's ``path_mate``.
    """
    w.counts[PATHS] = 0
    w.counts[POINTS] = 0
    w.counts[DEGREES] = 0
    w.counts[LOOSE] = 0
    for node in range(w.counts[NODES]):
        w.node_path[node] = -1
        if w.root[node] != node or node < corners or w.degree[node] == 0 or not on_sheet(w, w.x[node], w.y[node]):
            continue
        if w.level_at[node] >= 0 and w.degree[node] == 2:
            continue  # a ridge goes straight on here: no node
        if w.degree[node] % 2 == 1:
            w.counts[DEGREES] += 1
        first = w.counts[PATHS]
        h = w.at_node[node]
        while h >= 0:
            way = way_in(w, h)
            if way != 0 or (w.kind[h] == LEVEL and w.degree[node] > 2):
                k = w.counts[PATHS]
                if k >= len(w.path_cost):
                    return FULL
                side = w.face[h]
                if way != 0:
                    angle = atan2(way * w.ax[side], -way * w.ay[side])
                else:
                    angle = atan2(w.y[w.head[h]] - w.y[node], w.x[w.head[h]] - w.x[node])
                # in order of their angles
                while k > first and w.path_angle[k - 1] > angle:
                    w.path_angle[k], w.path_half[k] = w.path_angle[k - 1], w.path_half[k - 1]
                    k -= 1
                w.path_angle[k], w.path_half[k] = angle, h
                w.counts[PATHS] += 1
            h = w.next_at_node[h]
        last = w.counts[PATHS]
        if last > first:
            w.node_path[node] = first
        for k in range(first, last):
            w.path_next[k] = k + 1 if k + 1 < last else first
            w.path_before[k] = k - 1 if k > first else last - 1
            w.path_start[k] = node
            w.path_mate[k] = -1
            w.path_taken[k] = 0
            w.path_group[k] = -1
            w.path_point[k] = w.counts[POINTS]
            w.path_end[k] = -2
            w.counts[LOOSE] += 1
            w.path_cost[k] = w.sizes[ENDLESS_COST]
            if walk(w, w.path_half[k], 0, k):
                w.path_end[k] = w.ints[END]
                w.counts[LOOSE] -= 1
                w.path_cost[k] = w.ints[FOLDS] + 0.01 * w.ints[PIECES] - saved(w, k)
                w.path_last[k] = w.ints[LAST_FACE]
    w.path_point[w.counts[PATHS]] = w.counts[POINTS]
    for k in range(w.counts[PATHS]):
        end = w.path_end[k]
        if end >= corners and w.node_path[end] >= 0 and w.path_mate[k] < 0:
            other = w.node_path[end]
            first = other
            while True:
                if w.path_end[other] == w.path_start[k] and w.face[w.path_half[other]] == w.path_last[k]:
                    w.path_mate[k], w.path_mate[other] = other, k
                    break
                other = w.path_next[other]
                if other == first:
                    break
    return 0


@compiled
def find_groups(w):
    """Find the groups of nodes that perpendiculars join, and the corridors around each.

    ``path_sector`` is the corridor that comes next around the node, named by the perpendicular at which its border
    begins. ``sector_cost`` is what it costs to fold all perpendiculars of the group that do not border on it.
    """
    groups = 0
    for k in range(w.counts[PATHS]):
        if w.path_group[k] >= 0:
            continue
        # all of this group
        w.member[0] = k
        size, at = 1, 0
        w.path_group[k] = groups
        while at < size:
            p = w.member[at]
            at += 1
            for turn in range(2):
                q = w.path_next[p] if turn == 0 else w.path_mate[p]
                if q >= 0 and w.path_group[q] < 0:
                    w.path_group[q] = groups
                    w.member[size] = q
                    size += 1
        total = 0.0
        for at in range(size):
            p = w.member[at]
            w.path_sector[p] = -1
            if w.path_mate[p] < 0 or w.path_mate[p] > p:
                total += w.path_cost[p]
        w.group_first[groups] = k
        w.group_best[groups] = -1
        best = inf
        for at in range(size):
            first = w.member[at]
            if w.path_mate[first] >= 0:
                continue
            cost = total - w.path_cost[first]
            p, steps = first, 0
            while steps < 200:
                steps += 1
                w.path_sector[p] = first
                q = w.path_next[p]
                if w.path_mate[q] < 0:
                    if q != first:
                        cost -= w.path_cost[q]
                    else:
                        cost += w.path_cost[q]  # the corridor is on both sides of it
                    break
                cost -= w.path_cost[q]
                p = w.path_mate[q]
            w.sector_cost[first] = cost
            if cost < best:
                best = cost
                w.group_best[groups] = first
        # corridors that do not come to the border, with perpendiculars all around them
        for at in range(size):
            first = w.member[at]
            if w.path_sector[first] >= 0:
                continue
            cost, p, steps = total, first, 0
            while p >= 0 and w.path_sector[p] < 0 and steps < 200:
                steps += 1
                w.path_sector[p] = first
                q = w.path_next[p]
                cost -= w.path_cost[q]
                p = w.path_mate[q]
            w.sector_cost[first] = cost
            if cost < best:
                best = cost
                w.group_best[groups] = first
        groups += 1
        if groups >= len(w.group_first):
            return FULL
    w.counts[GROUPS] = groups
    return 0


@compiled
def sector_towards(w, group, x, y):
    """Return the corridor of a group in which a point lies."""
    first = w.group_first[group]
    node = w.path_start[first]
    ox, oy = w.x[node], w.y[node]
    dx, dy = x - ox, y - oy
    angle = atan2(dy, dx)
    # the last of the node's perpendiculars that comes before this angle
    k = w.node_path[node]
    begin = k
    last = w.path_before[begin]
    sector = last
    while True:
        if w.path_angle[k] <= angle:
            sector = k
        if k == last:
            break
        k = w.path_next[k]
    sector = w.path_sector[sector]
    latest = 1e-9
    for p in range(w.counts[PATHS]):
        if w.path_group[p] != group or (w.path_mate[p] >= 0 and w.path_mate[p] < p):
            continue
        for i in range(w.path_point[p], w.path_point[p + 1] - 1):
            ax, ay = w.point_x[i], w.point_y[i]
            ex, ey = w.point_x[i + 1] - ax, w.point_y[i + 1] - ay
            area = dx * ey - dy * ex
            if area == 0.0:
                continue
            part = ((ax - ox) * ey - (ay - oy) * ex) / area
            if latest < part < 1 - 1e-9:
                along = ((ax - ox) * dy - (ay - oy) * dx) / area
                if 0 <= along <= 1 and (i > w.path_point[p] or w.path_start[p] != node or along > 1e-9):
                    latest = part
                    # to its left if the way turns left of it
                    left = ex * dy - ey * dx > 0
                    sector = w.path_sector[p] if left else w.path_sector[w.path_before[p]]
    return sector


@compiled
def choose(w):
    """Choose the perpendiculars that fold all paper away from one corridor: of all corridors the cheapest.

    Of each group those are folded that do not border on the corridor towards that one (``methods.skeleton.choices``).
    """
    if find_groups(w) < 0:
        return FULL
    groups = w.counts[GROUPS]
    best, root = inf, -1
    for one in range(groups):
        if w.group_best[one] < 0:
            continue
        here = w.path_start[w.group_first[one]]
        if root >= 0 and is_small(w, one):
            continue  # nothing new beyond
        total = w.sector_cost[w.group_best[one]]
        for other in range(groups):
            if other != one and w.group_best[other] >= 0:
                if w.sector_cost[w.group_best[other]] + total >= best:
                    total = inf
                    break
                total += group_cost(w, other, here)
                if total >= best:
                    break
        if total < best:
            best, root = total, one
    w.counts[ENDLESS] = 0
    w.counts[STUCK] = 0
    if root < 0:
        return 0
    here = w.path_start[w.group_first[root]]
    for one in range(groups):
        if w.group_best[one] < 0:
            continue
        sector = w.group_best[one] if one == root else sector_towards(w, one, w.x[here], w.y[here])
        if sector < 0:
            sector = w.group_best[one]
        w.group_best[one] = sector
    for k in range(w.counts[PATHS]):
        group = w.path_group[k]
        sector = w.group_best[group]
        if sector < 0:
            continue
        borders = w.path_sector[k] == sector
        borders_too = w.path_sector[w.path_before[k]] == sector
        mate = w.path_mate[k]
        if mate >= 0:
            borders = borders or w.path_sector[w.path_before[mate]] == sector
            borders_too = borders_too or w.path_sector[mate] == sector
        if borders == borders_too and (mate < 0 or mate > k):
            if w.path_end[k] == -2:
                w.counts[ENDLESS] += 1
                if w.counts[STUCK] == 0 or w.stuck[w.counts[STUCK] - 1] != w.path_start[k]:
                    w.stuck[w.counts[STUCK]] = w.path_start[k]
                    w.counts[STUCK] += 1
            else:
                w.path_taken[k] = 1
    return 0


@inlined
def is_small(w, group):
    """Return whether a group is one perpendicular or two, which cost the same seen from anywhere."""
    first = w.group_first[group]
    following = w.path_next[first]
    return following == w.path_before[first] and w.path_mate[first] < 0 and w.path_mate[following] < 0


@compiled
def group_cost(w, group, node):
    """Return what a group costs if paper is folded away from a node."""
    if is_small(w, group):
        return w.sector_cost[w.group_best[group]]
    sector = sector_towards(w, group, w.x[node], w.y[node])
    return w.sector_cost[sector] if sector >= 0 else w.sector_cost[w.group_best[group]]


@inlined
def add_exit(w, x, y):
    """Note where a crease comes to an axis along which the sheet is folded first."""
    snap = w.sizes[SNAP]
    if w.sizes[FOLDED_X] > 0 and x <= snap and w.counts[EXITS_X] < len(w.exit_x):
        w.exit_x[w.counts[EXITS_X]] = y
        w.counts[EXITS_X] += 1
    if w.sizes[FOLDED_Y] > 0 and y <= snap and w.counts[EXITS_Y] < len(w.exit_y):
        w.exit_y[w.counts[EXITS_Y]] = x
        w.counts[EXITS_Y] += 1


@compiled
def measure_axis(w, places, count, length):
    """Measure the pieces of an axis between the creases that come to it."""
    for i in range(1, count):
        here, k = places[i], i
        while k > 0 and places[k - 1] > here:
            places[k] = places[k - 1]
            k -= 1
        places[k] = here
    before = 0.0
    for i in range(count + 1):
        here = places[i] if i < count else length
        if here - before > w.sizes[SNAP]:
            add_length(w, here - before)
        before = here


@compiled
def measure(w, corners):
    """Count the lines of ridges and of the chosen perpendiculars, and measure the pieces."""
    w.counts[SPOKES] = 0
    w.counts[CUTS] = 0
    w.counts[RIDGES] = 0
    w.counts[LINES] = 0
    w.counts[WAYS] = 0
    w.counts[MISSES] = 0
    w.counts[SHORT] = 0
    w.counts[TAKEN] = 0
    w.counts[EXITS_X] = 0
    w.counts[EXITS_Y] = 0
    w.numbers[SHORTEST] = inf
    w.numbers[PENALTY] = 0.0
    w.ints[CORNERS] = corners
    for k in range(w.counts[PATHS]):
        if w.path_taken[k]:
            w.taken[w.counts[TAKEN]] = k
            walk(w, w.path_half[k], 1, w.counts[TAKEN])
            w.counts[TAKEN] += 1
            w.counts[LINES] += w.ints[FOLDS]
    taken = w.counts[TAKEN]
    for k in range(w.counts[STUCK]):
        h = w.at_node[w.stuck[k]]
        while h >= 0:
            if taken < len(w.taken):
                w.taken[taken] = -1 - h
                walk(w, h, 2, taken)
                taken += 1
            h = w.next_at_node[h]
    w.way_first[taken] = w.counts[WAYS]
    w.ints[NOTED] = taken
    snap = w.sizes[SNAP]
    for h in range(w.counts[HALVES]):
        if w.kind[h] != RIDGE or w.twin[h] < h:
            continue
        a, b = w.tail[h], w.head[h]
        x, y, dx, dy = w.x[a], w.y[a], w.x[b] - w.x[a], w.y[b] - w.y[a]
        length = sqrt(dx * dx + dy * dy)
        low, high = 0.0, 1.0
        if abs(dx) > snap:
            s, t = -x / dx, (w.sizes[WIDTH] - x) / dx
            low, high = max(low, min(s, t)), min(high, max(s, t))
        elif not snap < x < w.sizes[WIDTH] - snap:
            continue
        if abs(dy) > snap:
            s, t = -y / dy, (w.sizes[HEIGHT] - y) / dy
            low, high = max(low, min(s, t)), min(high, max(s, t))
        elif not snap < y < w.sizes[HEIGHT] - snap:
            continue
        if (high - low) * length <= snap:
            continue
        k = w.counts[RIDGES]
        w.ridge[k], w.ridge_length[k] = h, length
        w.counts[RIDGES] += 1
        w.counts[LINES] += 1
        if low == 0.0 and on_sheet(w, x, y):
            add_spoke(w, a, dx, dy)
        if high == 1.0 and on_sheet(w, w.x[b], w.y[b]):
            add_spoke(w, b, -dx, -dy)
        if low > 0.0:
            add_exit(w, x + low * dx, y + low * dy)
        if high < 1.0:
            add_exit(w, x + high * dx, y + high * dy)
        at, before = w.cut_at[h], low
        while at >= 0:
            add_length(w, (w.cut_part[at] - before) * length)
            before, at = w.cut_part[at], w.cut_next[at]
        add_length(w, (high - before) * length)
    if w.sizes[FOLDED_X] > 0:
        measure_axis(w, w.exit_x, w.counts[EXITS_X], w.sizes[HEIGHT])
    if w.sizes[FOLDED_Y] > 0:
        measure_axis(w, w.exit_y, w.counts[EXITS_Y], w.sizes[WIDTH])
    w.numbers[COST] = (
        w.counts[LINES]
        + w.sizes[SHORT_COST] * w.counts[SHORT]
        + w.sizes[SHORTER_COST] * w.numbers[PENALTY]
        + w.sizes[ENDLESS_COST] * w.counts[ENDLESS]
        + w.sizes[LOOSE_COST] * w.counts[LOOSE]
    )
    return 0


@compiled
def assess(front, sides, faces, w, corners, flanks, scale, middle_x, middle_y):
    """Do all of the above."""
    if gather(front, sides, faces, w, corners, flanks, scale, middle_x, middle_y) < 0:
        return FULL
    if find_paths(w, corners) < 0:
        return FULL
    if choose(w) < 0:
        return FULL
    return measure(w, corners)
