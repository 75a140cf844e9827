"""A straight skeleton whose points move by little: what changes is computed again, and found to be right or not.

Points at new places -> nodes in ``Motion``, and whether they are those of the skeleton (``move``).

A side turns when one of its ends moves. Then the nodes of its face move, and with them the outlines of all faces that
have these nodes. It is still the straight skeleton of the graph if

1. each node that moved is on the lines of all its sides, as far as rounding tells;
2. each arc at such a node goes on in time;
3. each face that has such a node is a simple polygon, counter-clockwise, and nowhere but at its side is a place of it
   from which time only rises;
4. unbounded arcs beside each other do not converge, and all of them together go around once.

For then the faces, glued along their arcs, have around each node a whole number of turns, and by Euler's formula all
these together are as few as they can be: so each is one turn and the faces tile the plane. Each cut through them at a
time is a wavefront, and it moves as it should. Where rounding leaves any of this open, the answer is no.

Written like ``wavefront``: plain on lists, or compiled on arrays.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996 (faces and their arcs).
"""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

from foldcut.core.compiled import compiled_in
from foldcut.geometry.straight_skeleton.tables import Tables
from foldcut.geometry.straight_skeleton.wavefront import SAFETY, ULP

__all__ = ["Motion", "move", "prepare", "room_for", "set_velocities"]

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

POINT = "x y first:"
"""Place, and where its list of sides begins."""

SIDE = "dx dy ox oy turn tail: head: source: first: gaps: is_around: moved: seen:"
"""Direction and tail, as in ``wavefront``; where its face begins; how many gaps at the infinite that has, and whether
it goes around the direction of x there; when the side was moved and when its face was looked at."""

NODE = "x y time error a: b: c: first: moved:"
"""Place, time, and how uncertain these are; three of its sides, from which it is computed; where its sides begin."""

ARC = "vx vy drift start: end: left: right: is_level:"
"""As in ``wavefront``."""

STEP = "node: arc:"
"""A face's outline: a node, -1 for the infinite, and the arc to the next; -1 for the side itself."""

CORNER = "x y time moved:"
"""An outline with its places; what is at the infinite is cut off at a time."""

NOW, SIDES_MOVED, NODES_MOVED, FACES_SEEN = range(4)
POINTS = 4
NOISE, MIDDLE_X, MIDDLE_Y, SCALE = range(4)

STAYED, CHANGED, NO_POINT = range(3)

UNCERTAIN = 1 << 20
"""A node that may be off by so many roundings of the coordinates is left to ``wavefront``, which has decimals."""

FARTHEST = 2.0
"""How far from the middle points may move, in the frame."""


class Motion(NamedTuple):
    """The tables. ``sides_moved``, ``nodes_moved``, ``faces_seen`` list those of the last movement."""

    points: Any
    sides: Any
    nodes: Any
    arcs: Any
    steps: Any
    corners: Any
    point_sides: Any
    node_sides: Any
    sides_moved: Any
    nodes_moved: Any
    faces_seen: Any
    counts: Any
    numbers: Any


def room_for(tables: Tables, points: int, sides: int, nodes: int, arcs: int, steps: int, at_points: int) -> Motion:
    """Return tables for so many points, sides, nodes, arcs, steps of outlines, and ends of sides at points."""
    return Motion(
        points=tables.rows(POINT, points + 1),
        sides=tables.rows(SIDE, sides + 1),
        nodes=tables.rows(NODE, nodes + 1),
        arcs=tables.rows(ARC, arcs),
        steps=tables.rows(STEP, steps),
        corners=tables.rows(CORNER, 2 * steps),
        point_sides=tables.integers(at_points),
        node_sides=tables.integers(steps),
        sides_moved=tables.integers(sides),
        nodes_moved=tables.integers(nodes),
        faces_seen=tables.integers(sides),
        counts=tables.integers(8),
        numbers=tables.numbers(8),
    )


@compiled
def prepare(motion):
    """Choose the sides from which each node is computed, and find out how certain nodes and arcs are."""
    counts = motion.counts
    for side in range(len(motion.sides) - 1):
        turn_side(motion, side)
    for node in range(len(motion.nodes) - 1):
        motion.nodes[node].error = motion.numbers[NOISE]
        if node >= counts[POINTS]:
            choose_sides(motion, node)
            place_node(motion, node, False)
    for arc in range(len(motion.arcs)):
        set_velocity(motion, arc)
    for side in range(len(motion.sides) - 1):
        if motion.sides[side].gaps == 1:
            place = motion.sides[side].first
            while motion.steps[place].node >= 0:
                place += 1
            before = motion.steps[place - 1].arc
            motion.sides[side].is_around = goes_around(motion, before, motion.steps[place].arc)


@compiled
def turn_side(motion, side):
    """Compute a side's direction from its ends, as ``wavefront`` does; return whether it has a length."""
    source = motion.sides[side].source
    tail, head = motion.sides[source].tail, motion.sides[source].head
    dx = motion.points[head].x - motion.points[tail].x
    dy = motion.points[head].y - motion.points[tail].y
    length = sqrt(dx * dx + dy * dy)
    if not length > SAFETY * motion.numbers[NOISE]:
        return False
    if source == side:
        motion.sides[side].dx = dx / length
        motion.sides[side].dy = dy / length
    else:
        motion.sides[side].dx = dy / length
        motion.sides[side].dy = -dx / length
    motion.sides[side].ox = motion.points[motion.sides[side].tail].x
    motion.sides[side].oy = motion.points[motion.sides[side].tail].y
    motion.sides[side].turn = motion.numbers[NOISE] / length
    return True


@compiled
def choose_sides(motion, node):
    """Choose a node's first side, the one whose normal is farthest from that, and the one farthest from both."""
    first, last = motion.nodes[node].first, motion.nodes[node + 1].first
    a = motion.node_sides[first]
    b, c = a, a
    ax, ay = motion.sides[a].dx, motion.sides[a].dy
    most = -1.0
    for k in range(first, last):
        side = motion.node_sides[k]
        dx, dy = motion.sides[side].dx - ax, motion.sides[side].dy - ay
        if dx * dx + dy * dy > most:
            most = dx * dx + dy * dy
            b = side
    bx, by = motion.sides[b].dx - ax, motion.sides[b].dy - ay
    most = -1.0
    for k in range(first, last):
        side = motion.node_sides[k]
        cross = abs((motion.sides[side].dx - ax) * by - (motion.sides[side].dy - ay) * bx)
        if cross > most:
            most = cross
            c = side
    motion.nodes[node].a = a
    motion.nodes[node].b = b
    motion.nodes[node].c = c


@compiled
def place_node(motion, node, is_moved):
    """Compute how uncertain a node is, and where it is if it ``is_moved``; return whether its sides determine it.

    The differences of the three equations d x (X - o) = t do not have t in them; d is a direction, o a point.
    """
    a, b, c = motion.nodes[node].a, motion.nodes[node].b, motion.nodes[node].c
    ax, ay = motion.sides[a].dx, motion.sides[a].dy
    ux, uy = motion.sides[b].dx - ax, motion.sides[b].dy - ay
    wx, wy = motion.sides[c].dx - ax, motion.sides[c].dy - ay
    cross = ux * wy - uy * wx
    if abs(cross) <= ULP:
        motion.nodes[node].error = 1.0
        return False
    if is_moved:
        # relative to the tail of the first side, whose equation is then d x X = t
        ox, oy = motion.sides[a].ox, motion.sides[a].oy
        rb = motion.sides[b].dx * (motion.sides[b].oy - oy) - motion.sides[b].dy * (motion.sides[b].ox - ox)
        rc = motion.sides[c].dx * (motion.sides[c].oy - oy) - motion.sides[c].dy * (motion.sides[c].ox - ox)
        x, y = (wx * rb - ux * rc) / cross, (wy * rb - uy * rc) / cross
        motion.nodes[node].time = ax * y - ay * x
        motion.nodes[node].x = ox + x
        motion.nodes[node].y = oy + y
    # how far x, y and t move if the equations of b and c, and of a, are off by so much
    by_b = sqrt(wx * wx + wy * wy) / abs(cross)
    by_c = sqrt(ux * ux + uy * uy) / abs(cross)
    off_a, off_b, off_c = uncertainty(motion, node, a), uncertainty(motion, node, b), uncertainty(motion, node, c)
    motion.nodes[node].error = off_a * (1 + by_b + by_c) + off_b * by_b + off_c * by_c
    return motion.nodes[node].error < UNCERTAIN * motion.numbers[NOISE] * (1 + abs(motion.nodes[node].time))


@inlined
def uncertainty(motion, node, side):
    """Return how uncertain a side's line is at a node."""
    dx, dy = motion.nodes[node].x - motion.sides[side].ox, motion.nodes[node].y - motion.sides[side].oy
    noise = motion.numbers[NOISE] * (1 + abs(motion.nodes[node].time))
    return noise + motion.sides[side].turn * sqrt(dx * dx + dy * dy)


@compiled
def is_on_all_lines(motion, node):
    """Return whether a node is as far as its time says from the lines of all its sides."""
    a, b, c = motion.nodes[node].a, motion.nodes[node].b, motion.nodes[node].c
    for k in range(motion.nodes[node].first, motion.nodes[node + 1].first):
        side = motion.node_sides[k]
        if side in (a, b, c):
            continue
        dx, dy = motion.sides[side].dx, motion.sides[side].dy
        off = dx * (motion.nodes[node].y - motion.sides[side].oy) - dy * (motion.nodes[node].x - motion.sides[side].ox)
        off = abs(off - motion.nodes[node].time)
        if not off <= SAFETY * (motion.nodes[node].error + uncertainty(motion, node, side)):
            return False
    return True


@compiled
def set_velocity(motion, arc):
    """Compute an arc's velocity; return whether its sides determine it."""
    if motion.arcs[arc].is_level == 1:
        return True
    left, right = motion.arcs[arc].left, motion.arcs[arc].right
    ax, ay, bx, by = motion.sides[left].dx, motion.sides[left].dy, motion.sides[right].dx, motion.sides[right].dy
    cross = ax * by - ay * bx
    dot = ax * bx + ay * by
    uncertain = motion.sides[left].turn + motion.sides[right].turn + ULP
    if dot >= 0:
        vx, vy = -(ay + by) / (1 + dot), (ax + bx) / (1 + dot)
    elif abs(cross) > SAFETY * uncertain:
        vx, vy = (bx - ax) / cross, (by - ay) / cross
    else:
        return False
    motion.arcs[arc].vx = vx
    motion.arcs[arc].vy = vy
    motion.arcs[arc].drift = uncertain * (vx * vx + vy * vy)
    return True


@inlined
def goes_around(motion, before, after):
    """Return 1 if the way from one unbounded arc to the next, counter-clockwise, passes the direction of x."""
    is_below = motion.arcs[before].vy < 0 or (motion.arcs[before].vy == 0 and motion.arcs[before].vx < 0)
    is_above = motion.arcs[after].vy > 0 or (motion.arcs[after].vy == 0 and motion.arcs[after].vx > 0)
    return 1 if is_below and is_above else 0


@compiled
def move(motion, points, places, count):
    """Move points to places, x and y in turn; return whether the skeleton has ``STAYED`` the same but for its places.

    If it may have ``CHANGED``, the tables are of no more use. With ``NO_POINT`` nothing is moved.
    """
    counts, numbers = motion.counts, motion.numbers
    counts[NOW] += 1  # 0 is never
    counts[SIDES_MOVED], counts[NODES_MOVED], counts[FACES_SEEN] = 0, 0, 0
    now = counts[NOW]
    for k in range(count):
        if not 0 <= points[k] < counts[POINTS]:
            return NO_POINT
    for k in range(count):
        point = points[k]
        x = (places[2 * k] - numbers[MIDDLE_X]) / numbers[SCALE]
        y = (places[2 * k + 1] - numbers[MIDDLE_Y]) / numbers[SCALE]
        if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
            return CHANGED
        motion.points[point].x = x
        motion.points[point].y = y
        motion.nodes[point].x = x
        motion.nodes[point].y = y
        for j in range(motion.points[point].first, motion.points[point + 1].first):
            side = motion.point_sides[j]
            if motion.sides[side].moved != now:
                motion.sides[side].moved = now
                motion.sides_moved[counts[SIDES_MOVED]] = side
                counts[SIDES_MOVED] += 1
    for k in range(counts[SIDES_MOVED]):
        if not turn_side(motion, motion.sides_moved[k]):
            return CHANGED
    for k in range(counts[SIDES_MOVED]):
        side = motion.sides_moved[k]
        for j in range(motion.sides[side].first, motion.sides[side + 1].first):
            node = motion.steps[j].node
            if node >= 0 and motion.nodes[node].moved != now:
                motion.nodes[node].moved = now
                motion.nodes_moved[counts[NODES_MOVED]] = node
                counts[NODES_MOVED] += 1
                if node >= counts[POINTS] and not (place_node(motion, node, True) and is_on_all_lines(motion, node)):
                    return CHANGED
    for k in range(counts[NODES_MOVED]):
        node = motion.nodes_moved[k]
        for j in range(motion.nodes[node].first, motion.nodes[node + 1].first):
            side = motion.node_sides[j]
            if motion.sides[side].seen != now:
                motion.sides[side].seen = now
                motion.faces_seen[counts[FACES_SEEN]] = side
                counts[FACES_SEEN] += 1
    around = 0
    for k in range(counts[FACES_SEEN]):
        side = motion.faces_seen[k]
        around -= motion.sides[side].is_around
        if not is_face(motion, side):
            return CHANGED
        around += motion.sides[side].is_around
    return STAYED if around == 0 else CHANGED


@compiled
def set_velocities(motion):
    """Compute the velocities of the arcs beside all sides that have ever moved."""
    for arc in range(len(motion.arcs)):
        if motion.sides[motion.arcs[arc].left].moved > 0 or motion.sides[motion.arcs[arc].right].moved > 0:
            set_velocity(motion, arc)


@compiled
def is_face(motion, side):
    """Return whether a side's outline is that of a face; only what is at nodes that have moved is looked at."""
    now = motion.counts[NOW]
    first, last = motion.sides[side].first, motion.sides[side + 1].first
    if motion.sides[side].gaps > 1:
        return False
    latest, error = 0.0, 0.0
    for place in range(first, last):
        node = motion.steps[place].node
        if node >= 0:
            latest = max(latest, motion.nodes[node].time)
            error = max(error, motion.nodes[node].error)
    latest += 1
    corners = 0
    before = motion.steps[last - 1].arc
    for place in range(first, last):
        node, arc = motion.steps[place].node, motion.steps[place].arc
        if arc >= 0 and not goes_on(motion, arc, now):
            return False
        if node >= 0:
            motion.corners[corners].x = motion.nodes[node].x
            motion.corners[corners].y = motion.nodes[node].y
            motion.corners[corners].time = motion.nodes[node].time
            motion.corners[corners].moved = motion.nodes[node].moved
            corners += 1
        else:
            # the outline comes from the infinite on the arc after it
            if not set_velocity(motion, arc):
                return False
            dx, dy = motion.sides[side].dx, motion.sides[side].dy
            rate = (motion.arcs[before].vx - motion.arcs[arc].vx) * dx
            rate += (motion.arcs[before].vy - motion.arcs[arc].vy) * dy
            if not rate > SAFETY * (motion.arcs[before].drift + motion.arcs[arc].drift):
                return False
            motion.sides[side].is_around = goes_around(motion, before, arc)
            for ray in (before, arc):
                start = motion.arcs[ray].start
                late = latest - motion.nodes[start].time
                motion.corners[corners].x = motion.nodes[start].x + late * motion.arcs[ray].vx
                motion.corners[corners].y = motion.nodes[start].y + late * motion.arcs[ray].vy
                motion.corners[corners].time = latest
                motion.corners[corners].moved = motion.nodes[start].moved
                error = max(error, motion.nodes[start].error + late * motion.arcs[ray].drift)
                corners += 1
        before = arc
    return is_simple(motion, corners, SAFETY * error, now)


@inlined
def goes_on(motion, arc, now):
    """Return whether an arc at nodes that have moved goes on in time; an unbounded one gets its velocity."""
    start, end = motion.arcs[arc].start, motion.arcs[arc].end
    if end < 0:
        return motion.nodes[start].moved != now or set_velocity(motion, arc)
    if motion.nodes[start].moved != now and motion.nodes[end].moved != now:
        return True
    if motion.arcs[arc].is_level == 1:
        return False
    lasts = motion.nodes[end].time - motion.nodes[start].time
    return lasts > SAFETY * (motion.nodes[start].error + motion.nodes[end].error)


@compiled
def is_simple(motion, count, near, now):
    """Return whether corners make a simple polygon, counter-clockwise; places this ``near`` may be the same.

    The height of a corner above the side is its time. Where a moved corner is lower than both beside it, the face has
    to be below it.
    """
    if count < 3:
        return False
    area = 0.0
    ox, oy = motion.corners[0].x, motion.corners[0].y
    for k in range(count):
        after = k + 1 if k + 1 < count else 0
        before = k - 1 if k > 0 else count - 1
        ax, ay = motion.corners[k].x, motion.corners[k].y
        bx, by = motion.corners[after].x, motion.corners[after].y
        area += (ax - ox) * (by - oy) - (ay - oy) * (bx - ox)
        cx, cy = motion.corners[before].x, motion.corners[before].y
        if motion.corners[k].moved == now or motion.corners[after].moved == now or motion.corners[before].moved == now:
            turn = (ax - cx) * (by - ay) - (ay - cy) * (bx - ax)
            goes_back = (ax - cx) * (bx - ax) + (ay - cy) * (by - ay) < 0
            reach = max(abs(bx - ax) + abs(by - ay), abs(ax - cx) + abs(ay - cy))
            if goes_back and abs(turn) <= near * reach:
                return False
            time = motion.corners[k].time
            if time > 0 and time < motion.corners[before].time and time < motion.corners[after].time and turn > 0:
                return False
        # the sections that do not share an end with the one from here
        for other in range(k + 2, count - 1 if k == 0 else count):
            end = other + 1 if other + 1 < count else 0
            if (
                motion.corners[k].moved == now
                or motion.corners[after].moved == now
                or motion.corners[other].moved == now
                or motion.corners[end].moved == now
            ) and not (is_beside(motion, k, after, other, end, near) or is_beside(motion, other, end, k, after, near)):
                return False
    return area > 0


@inlined
def is_beside(motion, a, b, c, d, near):
    """Return whether the section from c to d is on one side of the line from a to b, or past one of its ends."""
    ax, ay = motion.corners[a].x, motion.corners[a].y
    ux, uy = motion.corners[b].x - ax, motion.corners[b].y - ay
    cx, cy = motion.corners[c].x - ax, motion.corners[c].y - ay
    dx, dy = motion.corners[d].x - ax, motion.corners[d].y - ay
    slack = near * (abs(ux) + abs(uy))
    one, other = ux * cy - uy * cx, ux * dy - uy * dx
    if (one > slack and other > slack) or (one < -slack and other < -slack):
        return True
    square = ux * ux + uy * uy
    one, other = ux * cx + uy * cy, ux * dx + uy * dy
    return (one < -slack and other < -slack) or (one > square + slack and other > square + slack)
