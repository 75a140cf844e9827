"""What an outline costs to fold, without folding it: its ridges and the cheapest set of perpendiculars.

A finished wavefront (``geometry.straight_skeleton``) -> counts, lengths and candidates in ``Work``.

The faces of the skeleton are kept as half-edges: half-edge h runs from ``tail[h]`` to ``head[h]`` with the face of side
``face[h]`` on its left, and ``twin[h]`` runs back. Every face is seen from its side: u is the distance along it. A
perpendicular is traced from half-edge to half-edge: in each face it goes from one chain straight to the other, so from
a half-edge along which u grows to one along which it falls, or the other way.

This file is run as it is, or compiled; nothing is allocated in it.
Source: Demaine, Demaine and Lubiw, "Folding and one straight cut suffice", 1999 (ridges and perpendiculars).
"""

from __future__ import annotations

from math import inf, sqrt

from foldcut.core.compiled import compiled_in
from foldcut.geometry.straight_skeleton.wavefront import ARCS as FRONT_ARCS
from foldcut.geometry.straight_skeleton.wavefront import NODES as FRONT_NODES

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

# kinds of half-edges
RIDGE, BASE, LEVEL = 0, 1, 2

# places in ``counts``
NODES, HALVES, PATHS, SPOKES, CUTS, RIDGES, WAYS, MISSES, TAKEN, ENDLESS, LINES, STUCK, SHORT, DEGREES = range(14)

# places in ``numbers``
SHORTEST, PENALTY, COST, LEAST_HEIGHT = range(4)

# places in ``sizes``
WIDTH, HEIGHT, SNAP, NEAR, LEAST_CREASE, ENDLESS_COST, REACH, SHORT_COST, SHORTER_COST = range(9)

MOST_CROSSINGS = 30
"""A perpendicular that crosses more faces is given up."""

MOST_PARTIAL = 9
"""Of a perpendicular that does not end, so many crossings are looked at for nodes that it passes."""

MOST_MATCHED = 10
"""Components with more odd nodes are matched greedily."""

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
        w.z[node] = it.time * scale
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

    0: nothing; returns whether it ends, its end in ``ints[0]`` (-1 the border) and its pieces in ``ints[1]``, and the
    half-edge at which the way back would begin in ``ints[2]``.
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
    w.ints[2] = -1
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
            begin_x, begin_y = to_x, to_y
        if is_end:
            w.ints[0] = -1 if ends_outside else -1 - h
            w.ints[1] = pieces
            w.ints[3] = lines
            if not ends_outside:
                w.ints[2] = face
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
    """Return the half-edge from a node into the face beyond it, if two faces are one there and it is no node; else -1."""
    if w.level_at[node] < 0 or w.degree[node] != 2:
        return -1
    h = w.at_node[node]
    while h >= 0:
        other = w.face[h]
        if other != face and way_in(w, h) != 0:
            if w.ax[face] * w.ax[other] + w.ay[face] * w.ay[other] < 1 - 1e-12:
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
        if node < w.ints[8] or node == start or not on_sheet(w, w.x[node], w.y[node]):
            continue
        miss = abs(w.u0[h] - u)
        if snap < miss < reach and w.counts[MISSES] < len(w.miss):
            k = w.counts[MISSES]
            w.miss[k] = miss
            w.miss_path[k], w.miss_step[k], w.miss_node[k] = path, crossing, node
            w.counts[MISSES] += 1


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


@compiled
def find_paths(w, corners):
    """Trace the perpendiculars from odd nodes, and from the nodes that these come to: all that end."""
    queue = w.queue
    filled = 0
    w.counts[PATHS] = 0
    for node in range(w.counts[NODES]):
        w.seen[node] = 0
        if w.root[node] == node and w.degree[node] % 2 == 1 and on_sheet(w, w.x[node], w.y[node]):
            queue[filled] = node
            w.seen[node] = 1
            filled += 1
    w.counts[DEGREES] = filled
    at = 0
    while at < filled:
        node = queue[at]
        at += 1
        h = w.at_node[node]
        while h >= 0:
            if walk(w, h, 0, 0):
                end = w.ints[0]
                # one between two nodes is found from both ends, and kept from one
                if end < 0 or not (w.seen[end] == 2 and is_known(w, end, node, w.ints[2])):
                    k = w.counts[PATHS]
                    if k >= len(w.path_cost):
                        return FULL
                    w.path_half[k] = h
                    w.path_start[k], w.path_end[k] = node, end
                    w.path_cost[k] = w.ints[3] + 0.01 * w.ints[1]
                    w.path_taken[k] = 0
                    w.path_last[k] = w.ints[2]
                    w.counts[PATHS] += 1
                if end >= corners and w.seen[end] == 0:
                    w.seen[end] = 1
                    queue[filled] = end
                    filled += 1
            h = w.next_at_node[h]
        w.seen[node] = 2
    return 0


@compiled
def is_known(w, start, end, face):
    """Return whether there is a perpendicular from a node to another one that begins in this face."""
    for k in range(w.counts[PATHS]):
        if w.path_start[k] == start and w.path_end[k] == end and w.face[w.path_half[k]] == face:
            return True
    return False


@compiled
def shortest_ways(w, source, place):
    """Find the cheapest ways along perpendiculars from a node to all others, and to the border.

    Rows of ``way_cost`` and ``way_path`` belong to odd nodes; the column after the last node is the border.
    """
    count = w.counts[NODES]
    for node in range(count + 1):
        w.way_cost[place, node] = inf
        w.way_path[place, node] = -1
    w.way_cost[place, source] = 0.0
    changed = True
    while changed:
        changed = False
        for k in range(w.counts[PATHS]):
            a, b = w.path_start[k], w.path_end[k]
            cost = w.path_cost[k]
            if b < 0:
                b = count
            if w.way_cost[place, a] + cost < w.way_cost[place, b] - 1e-9:
                w.way_cost[place, b] = w.way_cost[place, a] + cost
                w.way_path[place, b] = k
                changed = True
            if b < count and w.way_cost[place, b] + cost < w.way_cost[place, a] - 1e-9:
                w.way_cost[place, a] = w.way_cost[place, b] + cost
                w.way_path[place, a] = k
                changed = True


@compiled
def take_way(w, place, target):
    """Take the perpendiculars of the cheapest way from an odd node to a node or the border; twice taken is not taken."""
    count = w.counts[NODES]
    while w.way_path[place, target] >= 0:
        k = w.way_path[place, target]
        w.path_taken[k] = 1 - w.path_taken[k]
        b = w.path_end[k]
        if b < 0:
            b = count
        target = w.path_start[k] if b == target else b


@compiled
def choose(w):
    """Choose the cheapest set of perpendiculars that makes the creases at every node even.

    Odd nodes are matched with each other or with the sheet's border along cheapest ways: a least T-join. Counts the
    nodes that nothing can be done for.
    """
    count = w.counts[NODES]
    odd = w.counts[DEGREES]
    if odd > len(w.way_cost):
        return FULL
    w.counts[ENDLESS] = 0
    w.counts[STUCK] = 0
    for place in range(odd):
        shortest_ways(w, w.queue[place], place)
        w.mate[place] = -2
    # components of nodes that might be matched with each other
    for place in range(odd):
        if w.mate[place] != -2:
            continue
        w.member[0] = place
        size = 1
        w.mate[place] = -3
        at = 0
        while at < size:
            here = w.member[at]
            at += 1
            for other in range(odd):
                if w.mate[other] == -2:
                    together = w.way_cost[here, w.queue[other]]
                    if together < w.way_cost[here, count] + w.way_cost[other, count]:
                        w.mate[other] = -3
                        w.member[size] = other
                        size += 1
        if size == 1:
            w.mate[place] = -1
        elif size <= MOST_MATCHED:
            match_exactly(w, size)
        else:
            match_greedily(w, size)
    for place in range(odd):
        mate = w.mate[place]
        if mate == -1:
            if w.way_cost[place, count] < inf:
                take_way(w, place, count)
            else:
                w.counts[ENDLESS] += 1
                w.stuck[w.counts[STUCK]] = w.queue[place]
                w.counts[STUCK] += 1
        elif mate > place:
            take_way(w, place, w.queue[mate])
    return 0


@inlined
def pair_cost(w, one, other):
    """Return what it costs to match two odd nodes; an odd node with itself stands for the border."""
    if one == other:
        cost = w.way_cost[one, w.counts[NODES]]
        return cost if cost < inf else 1000.0
    cost = w.way_cost[one, w.queue[other]]
    return cost if cost < inf else 2000.0


@compiled
def match_exactly(w, size):
    """Match the members of a component, by going through all subsets."""
    full = 1 << size
    w.best[0] = 0.0
    for mask in range(1, full):
        low = 0
        while not (mask >> low) & 1:
            low += 1
        one = w.member[low]
        best, mate = inf, low
        rest = mask & ~(1 << low)
        for other in range(low, size):
            if other != low and not (mask >> other) & 1:
                continue
            left = rest & ~(1 << other)
            cost = w.best[left] + pair_cost(w, one, w.member[other])
            if cost < best:
                best, mate = cost, other
        w.best[mask] = best
        w.best_mate[mask] = mate
    mask = full - 1
    while mask:
        low = 0
        while not (mask >> low) & 1:
            low += 1
        other = w.best_mate[mask]
        if other == low:
            w.mate[w.member[low]] = -1
        else:
            w.mate[w.member[low]] = w.member[other]
            w.mate[w.member[other]] = w.member[low]
        mask &= ~(1 << low)
        mask &= ~(1 << other)


@compiled
def match_greedily(w, size):
    """Match the members of a component: again and again the two that save most."""
    count = w.counts[NODES]
    for k in range(size):
        w.mate[w.member[k]] = -1
    while True:
        best, one, other = 0.0, -1, -1
        for i in range(size):
            a = w.member[i]
            if w.mate[a] >= 0:
                continue
            for j in range(i + 1, size):
                b = w.member[j]
                if w.mate[b] >= 0:
                    continue
                apart = min(1000.0, w.way_cost[a, count]) + min(1000.0, w.way_cost[b, count])
                saved = apart - w.way_cost[a, w.queue[b]]
                if saved > best:
                    best, one, other = saved, a, b
        if one < 0:
            return
        w.mate[one], w.mate[other] = other, one


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
    w.numbers[SHORTEST] = inf
    w.numbers[PENALTY] = 0.0
    w.numbers[LEAST_HEIGHT] = inf
    w.ints[8] = corners
    for k in range(w.counts[PATHS]):
        if w.path_taken[k]:
            w.taken[w.counts[TAKEN]] = k
            walk(w, w.path_half[k], 1, w.counts[TAKEN])
            w.counts[TAKEN] += 1
            w.counts[LINES] += w.ints[3]
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
    w.ints[9] = taken
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
        at, before = w.cut_at[h], low
        while at >= 0:
            add_length(w, (w.cut_part[at] - before) * length)
            before, at = w.cut_part[at], w.cut_next[at]
        add_length(w, (high - before) * length)
    for node in range(corners, w.counts[NODES]):
        if w.root[node] == node and w.degree[node] > 0 and on_sheet(w, w.x[node], w.y[node]):
            w.numbers[LEAST_HEIGHT] = min(w.numbers[LEAST_HEIGHT], w.z[node])
    w.numbers[COST] = (
        w.counts[LINES]
        + w.sizes[SHORT_COST] * w.counts[SHORT]
        + w.sizes[SHORTER_COST] * w.numbers[PENALTY]
        + w.sizes[ENDLESS_COST] * w.counts[ENDLESS]
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
