"""The wavefront of a planar graph, moved from event to event until it has vanished or nothing more happens to it.

``Sides``, points -> nodes and arcs in ``Front``; then the faces in ``Faces``.

Each side moves sideways at unit speed towards the region on its left. A *vertex* of the wavefront runs between two
*fragments* of sides that follow each other, on the bisector of their lines. There are two kinds of events: a fragment
shrinks to nothing, and a reflex vertex hits a fragment. Whatever meets at one place is treated as one: the fragments
that end there are sorted by angle around the place, and each that leaves is joined to the one that arrives next to it,
counter-clockwise (``meet``). Two sides that come to lie on each other, face to face, have a wedge of no angle between
them; the vertex there runs along both at once, to the nearer of their other ends (``close``). So it does not matter in
which order simultaneous events are found, nor how many things they bring together.

Whether two things are at the same place is decided by how uncertain their places are: every vertex carries a bound on
its error, which comes from the rounding of the graph's coordinates and from the angles of its sides. Nothing depends on
the size of a drawing. A node's place is corrected to the lines of all its sides as soon as it is made, so errors do not
add up.

With many vertices, hits are looked for in a grid, for a short time ahead (``open_window``).

This file is run as it is, on lists, or compiled, on arrays (see ``tables``); so it uses nothing but numbers and columns.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996 (the wavefront and its
events); Huber, "Computing Straight Skeletons and Motorcycle Graphs", 2012, section 2 (vertices of any degree).
"""

from __future__ import annotations

from math import inf, sqrt

from foldcut.core.compiled import compiled_in

compiled = compiled_in(__name__)

NEVER = inf

SAFETY = 32.0
"""How many times their estimated error two places may be apart and still be the same."""

MOST_ERROR = 1e-8
"""Places farther apart than this part of the drawing are never the same."""

LATEST = 2.0**30
"""When nothing more can happen: in sizes of the drawing."""

ULP = 2.0**-52
"""The rounding of a number near 1."""

FEW = 300
"""With no more live vertices than this, all fragments are looked at; with more, those in the grid's cells."""

# states of a vertex
DEAD, CONVEX, REFLEX, CLOSING = 0, 1, 2, 3

# places in ``counts``
VERTICES, NODES, ARCS, WAITING, LIVING, ENTRIES_USED, GRID, MEETINGS, GROUP, STATUS, MEETINGS_BEFORE = range(11)

# places in ``numbers``
NOW, END, LOW_X, LOW_Y, WIDTH, HEIGHT, NOISE, REACH = range(8)

# values of the status
DONE, NO_ROOM, STUCK = 0, 1, 2


# The heap of vertices by their next event


@compiled
def rise(front, vertex):
    """Move a vertex towards the top of the heap, as far as its key wants."""
    place = front.heap_place[vertex]
    key = front.key[vertex]
    while place > 0:
        above = (place - 1) >> 1
        other = front.heap[above]
        if front.key[other] <= key:
            break
        front.heap[place] = other
        front.heap_place[other] = place
        place = above
    front.heap[place] = vertex
    front.heap_place[vertex] = place


@compiled
def sink(front, vertex):
    """Move a vertex towards the bottom of the heap, as far as its key wants."""
    place = front.heap_place[vertex]
    key = front.key[vertex]
    count = front.counts[WAITING]
    while True:
        below = 2 * place + 1
        if below >= count:
            break
        if below + 1 < count and front.key[front.heap[below + 1]] < front.key[front.heap[below]]:
            below += 1
        other = front.heap[below]
        if front.key[other] >= key:
            break
        front.heap[place] = other
        front.heap_place[other] = place
        place = below
    front.heap[place] = vertex
    front.heap_place[vertex] = place


@compiled
def set_next_event(front, vertex):
    """Put a vertex where it belongs in the heap, after one of its two events has changed."""
    key = min(front.shrinks[vertex], front.hits[vertex])
    old = front.key[vertex]
    front.key[vertex] = key
    if key < old:
        rise(front, vertex)
    elif key > old:
        sink(front, vertex)


@compiled
def leave_heap(front, vertex):
    place = front.heap_place[vertex]
    front.counts[WAITING] -= 1
    last = front.heap[front.counts[WAITING]]
    if last != vertex:
        front.heap[place] = last
        front.heap_place[last] = place
        rise(front, last)
        sink(front, last)


# Vertices


@compiled
def spread(front, vertex, time):
    """Return how far from its place at a time a vertex may be."""
    error = SAFETY * (front.error[vertex] + front.drift[vertex] * abs(time - front.born[vertex]))
    return min(error, MOST_ERROR * (1.0 + time))


@compiled
def distance_at(front, vertex, time, x, y):
    """Return how far a vertex is from a place at a time."""
    late = time - front.born[vertex]
    dx = front.x[vertex] + late * front.vx[vertex] - x
    dy = front.y[vertex] + late * front.vy[vertex] - y
    return sqrt(dx * dx + dy * dy)


@compiled
def new_vertex(front, left, right, node, is_start):
    """Make a vertex at a node between the side that arrives and the side that leaves, and return it.

    Its neighbours are still to be set. It is closing if the wedge between the sides has no angle; not at the start,
    where sides do not lie on each other.
    """
    vertex = front.counts[VERTICES]
    if vertex >= len(front.x):
        front.counts[STATUS] = NO_ROOM
        return 0
    front.counts[VERTICES] = vertex + 1
    ax, ay, bx, by = front.dx[left], front.dy[left], front.dx[right], front.dy[right]
    cross = ax * by - ay * bx
    dot = ax * bx + ay * by
    uncertain = front.turn[left] + front.turn[right] + ULP
    front.x[vertex] = front.node_x[node]
    front.y[vertex] = front.node_y[node]
    front.born[vertex] = front.node_time[node]
    front.left[vertex] = left
    front.right[vertex] = right
    front.node[vertex] = node
    front.mark[vertex] = 0
    front.shrinks[vertex] = NEVER
    front.hits[vertex] = NEVER
    front.key[vertex] = NEVER
    if not is_start and dot < 0.0 and abs(cross) <= SAFETY * uncertain:
        make_closing(front, vertex)
    else:
        if dot >= 0.0:
            vx, vy = -(ay + by) / (1.0 + dot), (ax + bx) / (1.0 + dot)
        else:
            vx, vy = (bx - ax) / cross, (by - ay) / cross
        square = vx * vx + vy * vy
        front.vx[vertex] = vx
        front.vy[vertex] = vy
        front.drift[vertex] = uncertain * square
        front.error[vertex] = front.node_error[node] * (1.0 + sqrt(square))
        front.state[vertex] = REFLEX if cross < 0.0 else CONVEX
    place = front.counts[LIVING]
    front.live[place] = vertex
    front.live_place[vertex] = place
    front.counts[LIVING] = place + 1
    place = front.counts[WAITING]
    front.heap[place] = vertex
    front.heap_place[vertex] = place
    front.counts[WAITING] = place + 1
    return vertex


@compiled
def make_closing(front, vertex):
    front.vx[vertex] = 0.0
    front.vy[vertex] = 0.0
    front.drift[vertex] = 0.0
    front.error[vertex] = front.node_error[front.node[vertex]]
    front.state[vertex] = CLOSING


@compiled
def end_vertex(front, vertex, node):
    """Take a vertex out of the wavefront at a node; the arc from the node where it was born is done."""
    if root(front, front.node[vertex]) != root(front, node):
        new_arc(front, vertex, node)
    front.state[vertex] = DEAD
    count = front.counts[LIVING] - 1
    front.counts[LIVING] = count
    last = front.live[count]
    front.live[front.live_place[vertex]] = last
    front.live_place[last] = front.live_place[vertex]
    leave_heap(front, vertex)


@compiled
def new_arc(front, vertex, end):
    arc = front.counts[ARCS]
    front.counts[ARCS] = arc + 1
    front.arc_start[arc] = front.node[vertex]
    front.arc_end[arc] = end
    front.arc_left[arc] = front.left[vertex]
    front.arc_right[arc] = front.right[vertex]
    front.arc_vx[arc] = front.vx[vertex]
    front.arc_vy[arc] = front.vy[vertex]
    front.arc_beyond[arc] = -1
    return arc


@compiled
def root(front, node):
    """Return the node that stands for all those at the place of this one."""
    while front.same_as[node] != node:
        node = front.same_as[node]
    return node


# Events


@compiled
def time_of_shrinking(front, start):
    """Return when the fragment that starts at a vertex has no length left."""
    end = front.next[start]
    if front.state[start] == CLOSING or front.state[end] == CLOSING:
        return NEVER
    side = front.right[start]
    dx, dy = front.dx[side], front.dy[side]
    rate = (front.vx[start] - front.vx[end]) * dx + (front.vy[start] - front.vy[end]) * dy
    if rate <= front.drift[start] + front.drift[end]:
        return NEVER
    since = max(front.born[start], front.born[end])
    late, early = since - front.born[end], since - front.born[start]
    length = (front.x[end] + late * front.vx[end] - front.x[start] - early * front.vx[start]) * dx
    length += (front.y[end] + late * front.vy[end] - front.y[start] - early * front.vy[start]) * dy
    time = since + length / rate
    return max(time, front.numbers[NOW]) if time <= LATEST else NEVER


@compiled
def time_of_hit(front, vertex, start, latest):
    """Return when a reflex vertex hits the fragment that starts at another; ``NEVER`` if not before ``latest``."""
    side = front.right[start]
    if side == front.left[vertex] or side == front.right[vertex]:
        return NEVER
    dx, dy = front.dx[side], front.dy[side]
    rate = 1.0 + dy * front.vx[vertex] - dx * front.vy[vertex]
    if rate <= front.drift[vertex]:
        return NEVER
    x, y, born = front.x[vertex], front.y[vertex], front.born[vertex]
    gap = dx * (y - front.oy[side]) - dy * (x - front.ox[side]) - born
    time = born + gap / rate
    if not time < latest:
        return NEVER
    end = front.next[start]
    if front.state[start] == CLOSING or front.state[end] == CLOSING:
        return NEVER
    now = front.numbers[NOW]
    slack = min(SAFETY * (front.error[vertex] + front.drift[vertex] * abs(now - born)) / rate, MOST_ERROR * (1.0 + now))
    if time < now - slack:
        return NEVER
    node = front.node[vertex]
    if time <= born + slack and (front.node[start] == node or front.node[end] == node):
        return NEVER
    time = max(time, now)
    x += (time - born) * front.vx[vertex]
    y += (time - born) * front.vy[vertex]
    near = spread(front, vertex, time)
    late = time - front.born[start]
    along = (x - front.x[start] - late * front.vx[start]) * dx + (y - front.y[start] - late * front.vy[start]) * dy
    if along < -near - spread(front, start, time):
        return NEVER
    late = time - front.born[end]
    along = (front.x[end] + late * front.vx[end] - x) * dx + (front.y[end] + late * front.vy[end] - y) * dy
    if along < -near - spread(front, end, time):
        return NEVER
    return time


@compiled
def consider(front, vertex, start):
    """Take a fragment as what a reflex vertex hits next, if that is earlier than what is known."""
    time = time_of_hit(front, vertex, start, front.hits[vertex])
    if time <= front.numbers[END] and time < front.hits[vertex]:
        front.hits[vertex] = time
        front.target[vertex] = start
        front.target_end[vertex] = front.next[start]
        if time < front.key[vertex]:
            front.key[vertex] = time
            rise(front, vertex)


@compiled
def look_for_hit(front, vertex):
    """Find what a reflex vertex hits next."""
    front.hits[vertex] = NEVER
    set_next_event(front, vertex)
    if front.counts[GRID] > 0:
        enter_vertex(front, vertex, False)
        return
    for place in range(front.counts[LIVING]):
        consider(front, vertex, front.live[place])


@compiled
def fragment_changed(front, start):
    """Find when the fragment from a vertex to the next shrinks to nothing, and which reflex vertices hit it before."""
    front.shrinks[start] = time_of_shrinking(front, start)
    set_next_event(front, start)
    if front.state[start] == CLOSING or front.state[front.next[start]] == CLOSING:
        return
    if front.counts[GRID] > 0:
        enter_fragment(front, start)
        return
    for place in range(front.counts[LIVING]):
        vertex = front.live[place]
        if front.state[vertex] == REFLEX:
            consider(front, vertex, start)


# What meets at one place


@compiled
def join(front, vertex):
    """Add a vertex to those that meet."""
    if front.mark[vertex] != front.counts[MEETINGS]:
        front.mark[vertex] = front.counts[MEETINGS]
        front.group[front.counts[GROUP]] = vertex
        front.counts[GROUP] += 1


@compiled
def meet(front, time, x, y, away, through):
    """Let all that is at one place at a time meet there: the joined vertices, and those beside them.

    ``away`` is how uncertain the place is; ``through`` the start of a fragment that passes through it, or -1.
    """
    counts = front.counts
    meeting = counts[MEETINGS]
    k = 0
    while k < counts[GROUP]:
        vertex = front.group[k]
        k += 1
        other = front.prev[vertex]
        if front.mark[other] != meeting and distance_at(front, other, time, x, y) <= away + spread(front, other, time):
            join(front, other)
        other = front.next[vertex]
        if front.mark[other] != meeting and distance_at(front, other, time, x, y) <= away + spread(front, other, time):
            join(front, other)
    if through >= 0 and (front.mark[through] == meeting or front.mark[front.next[through]] == meeting):
        through = -1
    node = node_at(front, time, x, y, away, through)

    rays = 0
    for k in range(counts[GROUP]):
        vertex = front.group[k]
        if front.mark[front.prev[vertex]] != meeting:
            rays = new_ray(front, rays, front.left[vertex], front.prev[vertex], 0)
        if front.mark[front.next[vertex]] != meeting:
            rays = new_ray(front, rays, front.right[vertex], front.next[vertex], 1)
    if through >= 0:
        rays = new_ray(front, rays, front.right[through], through, 0)
        rays = new_ray(front, rays, front.right[through], front.next[through], 1)
    for k in range(counts[GROUP]):
        end_vertex(front, front.group[k], node)
    if rays > 0:
        pair_rays(front, rays, node)


@compiled
def new_ray(front, rays, side, far, is_leaving):
    front.ray_side[rays] = side
    front.ray_far[rays] = far
    front.ray_out[rays] = is_leaving
    return rays + 1


@compiled
def pair_rays(front, rays, node):
    """Join each fragment that leaves a node to the one that arrives next to it, counter-clockwise."""
    first = 0
    while front.ray_out[first] == 0:
        first += 1
    side = front.ray_side[first]
    dx, dy = front.dx[side], front.dy[side]
    tie = 0.0
    for k in range(rays):
        tie = max(tie, front.turn[front.ray_side[k]])
    tie = SAFETY * (2.0 * tie + ULP)
    for k in range(rays):
        side = front.ray_side[k]
        sign = 1.0 if front.ray_out[k] == 1 else -1.0
        angle = quarter_turns(
            sign * (dx * front.dx[side] + dy * front.dy[side]), sign * (dx * front.dy[side] - dy * front.dx[side])
        )
        if angle > 4.0 - tie:
            angle -= 4.0
        if k == first:
            angle = 0.0
        front.ray_angle[k] = angle
        place = k
        while place > 0:
            other = front.order[place - 1]
            gap = angle - front.ray_angle[other]
            if gap > tie or (gap >= -tie and front.ray_out[other] >= front.ray_out[k]):
                break
            front.order[place] = other
            place -= 1
        front.order[place] = k
    # as with brackets: what leaves opens one, what arrives closes the last that is open
    depth = 0
    made = 0
    for turn in range(2 * rays):
        k = front.order[turn % rays]
        if front.ray_out[k] == 1:
            if turn < rays:
                front.stack[depth] = k
                depth += 1
        elif front.ray_out[k] == 0 and depth > 0:
            depth -= 1
            other = front.stack[depth]
            front.ray_out[k] = -1
            front.group[made] = new_pair(front, other, k, node)
            made += 1
    for k in range(made):
        vertex = front.group[k]
        before = front.prev[vertex]
        if front.state[vertex] == CLOSING:
            front.shrinks[vertex] = front.numbers[NOW]
            set_next_event(front, vertex)
            front.shrinks[before] = NEVER
            set_next_event(front, before)
        else:
            fragment_changed(front, before)
            fragment_changed(front, vertex)
    for k in range(made):
        vertex = front.group[k]
        if front.state[vertex] == REFLEX:
            if front.counts[GRID] > 0:
                enter_vertex(front, vertex, True)
            else:
                look_for_hit(front, vertex)


@compiled
def quarter_turns(cosine, sine):
    """Return a measure of an angle from 0 to 4, which grows with it."""
    if sine >= 0.0:
        return sine / (sine + cosine) if cosine >= 0.0 else 1.0 - cosine / (sine - cosine)
    return 2.0 + sine / (sine + cosine) if cosine < 0.0 else 3.0 + cosine / (cosine - sine)


@compiled
def new_pair(front, leaving, arriving, node):
    """Return a new vertex between a fragment that arrives at a node and one that leaves it."""
    vertex = new_vertex(front, front.ray_side[arriving], front.ray_side[leaving], node, False)
    before, after = front.ray_far[arriving], front.ray_far[leaving]
    front.prev[vertex] = before
    front.next[vertex] = after
    front.next[before] = vertex
    front.prev[after] = vertex
    if before == after and front.state[vertex] != CLOSING:
        make_closing(front, vertex)
    return vertex


@compiled
def node_at(front, time, x, y, away, through):
    """Return the node where a group meets: one where some of it was born just now, or else a new one."""
    found = -1
    for k in range(front.counts[GROUP]):
        vertex = front.group[k]
        near = away + SAFETY * front.error[vertex]
        dx, dy = front.x[vertex] - x, front.y[vertex] - y
        if abs(time - front.born[vertex]) <= near and sqrt(dx * dx + dy * dy) <= near and front.born[vertex] > 0.0:
            node = root(front, front.node[vertex])
            if found < 0:
                found = node
            elif found != node:
                found, node = min(found, node), max(found, node)
                front.same_as[node] = found
    if found >= 0:
        return found
    node = front.counts[NODES]
    if node >= len(front.node_x):
        front.counts[STATUS] = NO_ROOM
        return 0
    front.counts[NODES] = node + 1
    front.same_as[node] = node
    place_node(front, node, time, x, y, away, through)
    return node


@compiled
def place_node(front, node, time, x, y, away, through):
    """Put a node where it is equally far from its sides, by least squares, near to the place where it was found.

    Each side weighs by how certain its line is there, and so does the place itself, for directions in which the sides
    do not tell.
    """
    noise = front.numbers[NOISE]
    meeting = front.counts[MEETINGS]
    prior = noise / max(away / SAFETY, noise)
    prior = prior * prior
    error = 0.0
    for _ in range(2):
        xx, xy, xt, yy, yt, tt = prior, 0.0, 0.0, prior, 0.0, prior
        fx, fy, ft = 0.0, 0.0, 0.0
        count = front.counts[GROUP]
        for k in range(2 * count + 1):
            if k == 2 * count:
                if through < 0:
                    break
                side = front.right[through]
            elif k & 1 == 0:
                side = front.left[front.group[k >> 1]]
            else:
                vertex = front.group[k >> 1]
                if front.mark[front.next[vertex]] == meeting:
                    continue
                side = front.right[vertex]
            nx, ny = -front.dy[side], front.dx[side]
            rx, ry = x - front.ox[side], y - front.oy[side]
            off = nx * rx + ny * ry - time
            weight = noise / (noise * (1.0 + time) + front.turn[side] * sqrt(rx * rx + ry * ry))
            weight = weight * weight
            xx += weight * nx * nx
            xy += weight * nx * ny
            yy += weight * ny * ny
            xt -= weight * nx
            yt -= weight * ny
            tt += weight
            fx -= weight * nx * off
            fy -= weight * ny * off
            ft += weight * off
        # the matrix (xx xy xt; xy yy yt; xt yt tt) as a product of triangles
        b = xy / xx
        c = xt / xx
        p = max(yy - b * xy, prior)
        q = (yt - c * xy) / p
        r = max(tt - c * xt - q * q * p, prior)
        gy = fy - b * fx
        gt = ft - c * fx - q * gy
        dt = gt / r
        dy = gy / p - q * dt
        dx = fx / xx - b * dy - c * dt
        x += dx
        y += dy
        time += dt
        # the trace of the inverse
        e = b * q - c
        error = 1.0 / xx + (1.0 + b * b) / p + (1.0 + q * q + e * e) / r
    front.node_x[node] = x
    front.node_y[node] = y
    front.node_time[node] = time
    front.node_error[node] = noise * sqrt(error)


@compiled
def new_meeting(front):
    front.counts[MEETINGS] += 1
    front.counts[GROUP] = 0


@compiled
def meet_at_vertex(front, vertex, other, through, time):
    """Let a vertex, and another or a fragment that it hits, meet where the more certain of the two vertices is."""
    new_meeting(front)
    join(front, vertex)
    sure = vertex
    if other >= 0:
        join(front, other)
        if spread(front, other, time) < spread(front, vertex, time):
            sure = other
    late = time - front.born[sure]
    x = front.x[sure] + late * front.vx[sure]
    y = front.y[sure] + late * front.vy[sure]
    away = spread(front, sure, time) if other < 0 else max(spread(front, vertex, time), spread(front, other, time))
    meet(front, time, x, y, away, through)


@compiled
def hit(front, vertex, time):
    """Let a reflex vertex hit its fragment, or one of the fragment's ends."""
    start, end = front.target[vertex], front.target_end[vertex]
    if front.state[start] == DEAD or front.next[start] != end:
        look_for_hit(front, vertex)
        return
    late = time - front.born[vertex]
    x = front.x[vertex] + late * front.vx[vertex]
    y = front.y[vertex] + late * front.vy[vertex]
    near = spread(front, vertex, time)
    for other in (start, end):
        if distance_at(front, other, time, x, y) <= near + spread(front, other, time):
            meet_at_vertex(front, vertex, other, -1, time)
            return
    meet_at_vertex(front, vertex, -1, start, time)


@compiled
def close(front, vertex, time):
    """Let two sides that lie on each other end: as far as to the nearer of their other ends, they are done."""
    before, after = front.prev[vertex], front.next[vertex]
    x, y = front.x[vertex], front.y[vertex]
    to_before = distance_at(front, before, time, x, y)
    to_after = distance_at(front, after, time, x, y)
    far = after if to_after <= to_before else before
    new_meeting(front)
    join(front, far)
    join(front, vertex)
    late = time - front.born[far]
    x = front.x[far] + late * front.vx[far]
    y = front.y[far] + late * front.vy[far]
    meet(front, time, x, y, spread(front, far, time), -1)


# The grid


@compiled
def open_window(front):
    """Look ahead for a while: put all fragments and reflex vertices into the cells that they pass until then.

    The grid covers the vertices as they are now and has some cells for each; what is outside goes to its outermost
    cells. How far to look ahead follows from how much has happened in the window before.
    """
    counts, numbers = front.counts, front.numbers
    count = counts[LIVING]
    for place in range(count):
        front.hits[front.live[place]] = NEVER
        set_next_event(front, front.live[place])
    start = max(numbers[NOW], numbers[END])
    numbers[NOW] = start
    if count <= FEW:
        counts[GRID] = 0
        numbers[END] = LATEST
        for place in range(count):
            vertex = front.live[place]
            if front.state[vertex] == REFLEX:
                look_for_hit(front, vertex)
        return
    low_x, low_y, high_x, high_y = NEVER, NEVER, -NEVER, -NEVER
    for place in range(count):
        vertex = front.live[place]
        late = start - front.born[vertex]
        x, y = front.x[vertex] + late * front.vx[vertex], front.y[vertex] + late * front.vy[vertex]
        low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
    grid = 1
    most = int(sqrt(float(len(front.cell_fragments))) + 0.5)
    while grid * grid < 4 * count and grid < most:
        grid += 1
    counts[GRID] = grid
    size = max(high_x - low_x, high_y - low_y) + ULP
    numbers[LOW_X], numbers[LOW_Y] = low_x, low_y
    numbers[WIDTH] = (high_x - low_x + MOST_ERROR * size) / grid
    numbers[HEIGHT] = (high_y - low_y + MOST_ERROR * size) / grid
    happened = counts[MEETINGS] - counts[MEETINGS_BEFORE]
    counts[MEETINGS_BEFORE] = counts[MEETINGS]
    if happened * 16 < count:
        numbers[REACH] *= 2.0
    elif happened * 2 > count:
        numbers[REACH] *= 0.5
    numbers[END] = min(start + numbers[REACH] * size / grid, LATEST)
    counts[ENTRIES_USED] = 0
    for cell in range(grid * grid):
        front.cell_fragments[cell] = -1
        front.cell_vertices[cell] = -1
    for place in range(count):
        enter_fragment(front, front.live[place])
    for place in range(count):
        if front.state[front.live[place]] == REFLEX:
            enter_vertex(front, front.live[place], True)


@compiled
def enter_fragment(front, start):
    """Enter a fragment into the cells that it passes, and see which reflex vertices there hit it."""
    numbers = front.numbers
    begin = numbers[NOW]
    end = front.next[start]
    side = front.right[start]
    dx, dy = front.dx[side], front.dy[side]
    ox, oy = front.ox[side] - begin * dy, front.oy[side] + begin * dx
    low, high = NEVER, -NEVER
    for k in range(4):
        vertex = start if k < 2 else end
        late = (begin if k & 1 == 0 else numbers[END]) - front.born[vertex]
        along = (front.x[vertex] + late * front.vx[vertex] - ox) * dx
        along += (front.y[vertex] + late * front.vy[vertex] - oy) * dy
        low, high = min(low, along), max(high, along)
    ahead = numbers[END] - begin
    enter(front, start, ox + low * dx, oy + low * dy, ox + high * dx, oy + high * dy, -ahead * dy, ahead * dx, 0)


@compiled
def enter_vertex(front, vertex, stays):
    """See which fragments a reflex vertex hits in the cells that it passes; enter it there if it ``stays``."""
    numbers = front.numbers
    late = numbers[NOW] - front.born[vertex]
    x, y = front.x[vertex] + late * front.vx[vertex], front.y[vertex] + late * front.vy[vertex]
    ahead = numbers[END] - numbers[NOW]
    enter(front, vertex, x, y, x + ahead * front.vx[vertex], y + ahead * front.vy[vertex], 0.0, 0.0, 2 if stays else 1)


@compiled
def enter(front, item, x0, y0, x1, y1, ex, ey, kind):
    """Visit the cells that a line from (x0, y0) to (x1, y1) passes while it moves by (ex, ey).

    ``kind`` is 0 for a fragment, 1 for a reflex vertex, 2 for one that is entered as well.
    """
    numbers = front.numbers
    grid = front.counts[GRID]
    # in cells, with the axis along which the line is longer first
    low_x, low_y, width, height = numbers[LOW_X], numbers[LOW_Y], numbers[WIDTH], numbers[HEIGHT]
    x0, x1, ex = (x0 - low_x) / width, (x1 - low_x) / width, ex / width
    y0, y1, ey = (y0 - low_y) / height, (y1 - low_y) / height, ey / height
    is_steep = abs(y1 - y0) > abs(x1 - x0)
    if is_steep:
        x0, y0, x1, y1, ex, ey = y0, x0, y1, x1, ey, ex
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    slope = (y1 - y0) / (x1 - x0) if x1 > x0 else 0.0
    margin = 1e-3
    least_ex, most_ex, least_ey, most_ey = min(ex, 0.0), max(ex, 0.0), min(ey, 0.0), max(ey, 0.0)
    first = cell_of(x0 + least_ex - margin, grid)
    last = cell_of(x1 + most_ex + margin, grid)
    for column in range(first, last + 1):
        # where on the line this column can come from
        begin = x0 if column == 0 else min(max(column - margin - most_ex, x0), x1)
        stop = x1 if column == grid - 1 else min(max(column + 1 + margin - least_ex, x0), x1)
        from_y, to_y = y0 + (begin - x0) * slope, y0 + (stop - x0) * slope
        bottom = cell_of(min(from_y, to_y) + least_ey - margin, grid)
        top = cell_of(max(from_y, to_y) + most_ey + margin, grid)
        for row in range(bottom, top + 1):
            visit(front, column * grid + row if is_steep else row * grid + column, item, kind)


@compiled
def cell_of(place, grid):
    if not place > 0.0:
        return 0
    return int(place) if place < grid else grid - 1


@compiled
def visit(front, cell, item, kind):
    """Compare a fragment with the vertices of a cell, or a vertex with its fragments, and enter it there."""
    entry = front.cell_vertices[cell] if kind == 0 else front.cell_fragments[cell]
    while entry >= 0:
        other = front.entry_item[entry]
        if kind == 0:
            if front.state[other] == REFLEX:
                consider(front, other, item)
        elif front.state[other] != DEAD:
            consider(front, item, other)
        entry = front.entry_next[entry]
    if kind == 1:
        return
    entry = front.counts[ENTRIES_USED]
    if entry >= len(front.entry_item):
        front.counts[STATUS] = NO_ROOM
        return
    front.counts[ENTRIES_USED] = entry + 1
    front.entry_item[entry] = item
    if kind == 0:
        front.entry_next[entry] = front.cell_fragments[cell]
        front.cell_fragments[cell] = entry
    else:
        front.entry_next[entry] = front.cell_vertices[cell]
        front.cell_vertices[cell] = entry


# From the start to the end


@compiled
def start(front, sides, x, y, noise):
    """Set the wavefront of a graph on its points: it has a vertex at the head of every side."""
    counts, numbers = front.counts, front.numbers
    for k in range(len(counts)):
        counts[k] = 0
        numbers[k] = 0.0
    numbers[NOISE] = noise
    numbers[REACH] = 1.0
    for point in range(len(x)):
        front.node_x[point] = x[point]
        front.node_y[point] = y[point]
        front.node_time[point] = 0.0
        front.node_error[point] = noise
        front.same_as[point] = point
    counts[NODES] = len(x)
    for side in range(len(sides.tail)):
        source = sides.source[side]
        tail, head = sides.tail[source], sides.head[source]
        dx, dy = x[head] - x[tail], y[head] - y[tail]
        length = sqrt(dx * dx + dy * dy)
        if source == side:
            front.dx[side], front.dy[side] = dx / length, dy / length
        else:
            front.dx[side], front.dy[side] = dy / length, -dx / length
        front.ox[side], front.oy[side] = x[sides.tail[side]], y[sides.tail[side]]
        front.turn[side] = noise / length
    for side in range(len(sides.tail)):
        new_vertex(front, side, sides.following[side], sides.head[side], True)
    for side in range(len(sides.tail)):
        front.next[side] = sides.following[side]
        front.prev[sides.following[side]] = side
    for vertex in range(len(sides.tail)):
        front.shrinks[vertex] = time_of_shrinking(front, vertex)
        set_next_event(front, vertex)
    open_window(front)


@compiled
def run(front, sides, x, y, noise):
    """Move the wavefront of a graph from the points with these coordinates to its end; return the status.

    ``noise`` is the rounding of the coordinates, which must be within -1 and 1.
    """
    start(front, sides, x, y, noise)
    counts, numbers = front.counts, front.numbers
    most = 64 * len(sides.tail) + 1024
    while counts[WAITING] > 0 and counts[STATUS] == DONE:
        vertex = front.heap[0]
        time = front.key[vertex]
        if time > numbers[END]:
            if numbers[END] >= LATEST:
                break
            open_window(front)
            continue
        numbers[NOW] = max(numbers[NOW], time)
        time = numbers[NOW]
        if front.state[vertex] == CLOSING:
            close(front, vertex, time)
        elif front.shrinks[vertex] <= front.hits[vertex]:
            meet_at_vertex(front, vertex, front.next[vertex], -1, time)
        else:
            hit(front, vertex, time)
        if counts[MEETINGS] > most:
            counts[STATUS] = STUCK
    if counts[STATUS] == DONE:
        leave_for_ever(front)
    return counts[STATUS]


@compiled
def leave_for_ever(front):
    """Make the unbounded arcs of the vertices that nothing more happens to."""
    for place in range(front.counts[LIVING]):
        vertex = front.live[place]
        front.target[vertex] = new_arc(front, vertex, -1)
    for place in range(front.counts[LIVING]):
        vertex = front.live[place]
        front.arc_beyond[front.target[vertex]] = front.target[front.prev[vertex]]


@compiled
def gather_faces(front, sides, faces):
    """Put the nodes of every face in order, counter-clockwise from its side's tail; -1 for the infinite.

    Half-edge 2k runs along arc k with the face on its left, 2k + 1 against it. Returns False where half-edges do not
    make one outline.
    """
    count = len(sides.tail)
    for side in range(count):
        faces.first[side] = -1
    for node in range(front.counts[NODES]):
        faces.node_face[node] = -1
    for arc in range(front.counts[ARCS]):
        start = root(front, front.arc_start[arc])
        end = front.arc_end[arc]
        end = root(front, end) if end >= 0 else -1
        front.arc_start[arc] = start
        front.arc_end[arc] = end
        if start == end:
            continue
        faces.following[2 * arc] = faces.first[front.arc_left[arc]]
        faces.first[front.arc_left[arc]] = 2 * arc
        faces.following[2 * arc + 1] = faces.first[front.arc_right[arc]]
        faces.first[front.arc_right[arc]] = 2 * arc + 1
    filled = 0
    for side in range(count):
        faces.offsets[side] = filled
        left = 0
        half = faces.first[side]
        while half >= 0:
            arc = half >> 1
            node = front.arc_start[arc] if half & 1 == 0 else front.arc_end[arc]
            if node >= 0:
                if faces.node_face[node] == side:
                    return False
                faces.node_face[node] = side
                faces.at_node[node] = half
            left += 1
            half = faces.following[half]
        tail, head = sides.tail[side], sides.head[side]
        node = tail
        if tail != head:
            faces.values[filled] = tail
            filled += 1
            node = head
        while True:
            faces.values[filled] = node
            filled += 1
            if faces.node_face[node] != side:
                return False
            half = faces.at_node[node]
            left -= 1
            arc = half >> 1
            following = front.arc_end[arc] if half & 1 == 0 else front.arc_start[arc]
            if following < 0:
                faces.values[filled] = -1
                filled += 1
                following = front.arc_start[front.arc_beyond[arc]]
                left -= 1
            node = following
            if node == tail:
                break
            if left <= 0:
                return False
        if left != 0:
            return False
    faces.offsets[count] = filled
    return True
