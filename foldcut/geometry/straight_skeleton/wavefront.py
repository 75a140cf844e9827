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

This file is run as it is, on lists, or compiled, on arrays (see ``tables``), and where doubles are not precise enough
once more with decimal numbers of many digits (``must_be_sure``); so it uses nothing but numbers and tables.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996 (the wavefront and its
events); Huber, "Computing Straight Skeletons and Motorcycle Graphs", 2012, section 2 (vertices of any degree).
"""

from __future__ import annotations

from math import floor, inf, sqrt

from foldcut.core.compiled import compiled_in

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

NEVER = inf

SAFETY = 32
"""How many times their estimated error two places may be apart and still be the same."""

MOST_ERROR = 1e-8
"""Places farther apart than this part of the drawing are never the same."""

LATEST = 1 << 60
"""When nothing more can happen: in sizes of the drawing."""

FAR = 1 << 30
"""Whether two bisectors are parallel, or meet farther away than this, doubles need not tell."""

SURE = 500
"""Where places that are farther apart than so many roundings of the coordinates are taken as the same, or where a node
is that uncertain, doubles are not precise enough."""

PARALLEL = 1e-9
"""Velocities that differ by less do not tell which of two unbounded arcs is beside which."""

SQUARE = 2.0**-22
"""The side of the squares by which nodes are found again; larger than any error."""

ULP = 2.0**-52
"""The rounding of a number near 1."""

FEW = 300
"""With no more live vertices than this, all fragments are looked at; with more, those in the grid's cells."""

FIRST_REACH = 0.25
"""How long to look ahead at first, in which a vertex at unit speed passes this part of a cell."""

LEAST_REACH = 2.0**-10
"""How long to look ahead at least."""

LATE = 0.5
"""From this time on little happens that is not already on its way to the infinite."""

FEW_LATE = 3000
"""The same as ``FEW``, from then on."""

# states of a vertex
DEAD, CONVEX, REFLEX, CLOSING = 0, 1, 2, 3

# places in ``counts``
VERTICES, NODES, ARCS, WAITING, LIVING, GROUP, STATUS, UNSURE, WRONG_FACES = range(9)
ENTRIES_USED, GRID, FULL, MEETINGS, MEETINGS_BEFORE = range(9, 14)

# places in ``numbers``
NOW, END, LOW_X, LOW_Y, WIDTH, HEIGHT, NOISE, REACH = range(8)

# ways of a face's outline along its side
FORTH, BACK, FORTH_AGAIN, WRONG = 0, 1, 2, 3

# values of the status
DONE, NO_ROOM, STUCK = 0, 1, 2


# The heap of vertices by their next event


@compiled
def rise(front, vertex):
    """Move a vertex towards the top of the heap, as far as its key wants."""
    place = front.vertices[vertex].heap_place
    key = front.vertices[vertex].key
    while place > 0:
        above = (place - 1) >> 1
        other = front.slots[above].heap
        if front.vertices[other].key <= key:
            break
        front.slots[place].heap = other
        front.vertices[other].heap_place = place
        place = above
    front.slots[place].heap = vertex
    front.vertices[vertex].heap_place = place


@compiled
def sink(front, vertex):
    """Move a vertex towards the bottom of the heap, as far as its key wants."""
    place = front.vertices[vertex].heap_place
    key = front.vertices[vertex].key
    count = front.counts[WAITING]
    while True:
        below = 2 * place + 1
        if below >= count:
            break
        if below + 1 < count:
            one, other = front.slots[below].heap, front.slots[below + 1].heap
            if front.vertices[other].key < front.vertices[one].key:
                below += 1
        other = front.slots[below].heap
        if front.vertices[other].key >= key:
            break
        front.slots[place].heap = other
        front.vertices[other].heap_place = place
        place = below
    front.slots[place].heap = vertex
    front.vertices[vertex].heap_place = place


@compiled
def set_next_event(front, vertex):
    """Put a vertex where it belongs in the heap, after one of its two events has changed."""
    key = min(front.vertices[vertex].shrinks, front.vertices[vertex].hits)
    old = front.vertices[vertex].key
    front.vertices[vertex].key = key
    if key < old:
        rise(front, vertex)
    elif key > old:
        sink(front, vertex)


@compiled
def leave_heap(front, vertex):
    """Take a vertex out of the heap."""
    place = front.vertices[vertex].heap_place
    front.counts[WAITING] -= 1
    last = front.slots[front.counts[WAITING]].heap
    if last != vertex:
        front.slots[place].heap = last
        front.vertices[last].heap_place = place
        rise(front, last)
        sink(front, last)


# Vertices


@inlined
def x_at(moving, time):
    """Return where a vertex is at a time."""
    return moving.x + (time - moving.born) * moving.vx


@inlined
def y_at(moving, time):
    """Return where a vertex is at a time."""
    return moving.y + (time - moving.born) * moving.vy


@compiled
def spread(moving, time):
    """Return how far from its place at a time a vertex may be."""
    error = SAFETY * (moving.error + moving.drift * abs(time - moving.born))
    return min(error, MOST_ERROR * (1 + time))


@inlined
def distance_at(moving, time, x, y):
    """Return how far a vertex is from a place at a time."""
    dx, dy = x_at(moving, time) - x, y_at(moving, time) - y
    return sqrt(dx * dx + dy * dy)


@compiled
def new_vertex(front, left, right, node, is_start):
    """Make a vertex at a node between the side that arrives and the side that leaves, and return it.

    Its neighbours are still to be set. It is closing if the wedge between the sides has no angle; not at the start,
    where sides do not lie on each other.
    """
    vertex = front.counts[VERTICES]
    if vertex >= len(front.vertices):
        front.counts[STATUS] = NO_ROOM
        return 0
    front.counts[VERTICES] = vertex + 1
    new, birth, a, b = front.vertices[vertex], front.nodes[node], front.sides[left], front.sides[right]
    new.x, new.y, new.born = birth.x, birth.y, birth.time
    new.left, new.right, new.node = left, right, node
    new.sibling = birth.born
    birth.born = vertex
    new.mark = 0
    new.passed = -1
    new.entered = new.shrinks = new.hits = new.key = NEVER
    cross = a.dx * b.dy - a.dy * b.dx
    dot = a.dx * b.dx + a.dy * b.dy
    uncertain = a.turn + b.turn + ULP
    if not is_start and dot < 0 and abs(cross) <= SAFETY * uncertain:
        make_closing(front, vertex)
    else:
        if dot >= 0:
            new.vx, new.vy = -(a.dy + b.dy) / (1 + dot), (a.dx + b.dx) / (1 + dot)
        else:
            new.vx, new.vy = (b.dx - a.dx) / cross, (b.dy - a.dy) / cross
        square = new.vx * new.vx + new.vy * new.vy
        new.drift = uncertain * square
        new.error = birth.error * (1 + sqrt(square))
        new.state = REFLEX if cross < 0 else CONVEX
    new.live_place = front.counts[LIVING]
    front.slots[new.live_place].live = vertex
    front.counts[LIVING] += 1
    new.heap_place = front.counts[WAITING]
    front.slots[new.heap_place].heap = vertex
    front.counts[WAITING] += 1
    return vertex


@compiled
def make_closing(front, vertex):
    """Let a vertex run along two sides that lie on each other."""
    closing = front.vertices[vertex]
    closing.vx = closing.vy = closing.drift = 0
    closing.error = front.nodes[closing.node].error
    closing.state = CLOSING


@compiled
def end_vertex(front, vertex, node):
    """Take a vertex out of the wavefront at a node; the arc from the node where it was born is done."""
    ended = front.vertices[vertex]
    if root(front, ended.node) != root(front, node):
        new_arc(front, vertex, node)
    ended.state = DEAD
    front.counts[LIVING] -= 1
    last = front.slots[front.counts[LIVING]].live
    front.slots[ended.live_place].live = last
    front.vertices[last].live_place = ended.live_place
    leave_heap(front, vertex)


@compiled
def new_arc(front, vertex, end):
    """Make the arc of a vertex from its birth to a node, -1 if it goes on for ever, and return it."""
    number = front.counts[ARCS]
    front.counts[ARCS] = number + 1
    arc, moving = front.arcs[number], front.vertices[vertex]
    arc.start, arc.end, arc.beyond = moving.node, end, -1
    arc.left, arc.right = moving.left, moving.right
    arc.vx, arc.vy = moving.vx, moving.vy
    return number


@inlined
def root(front, node):
    """Return the node that stands for all those at the place of this one."""
    while front.nodes[node].same_as != node:
        node = front.nodes[node].same_as
    return node


# Events


@inlined
def time_of_shrinking(front, start):
    """Return when the fragment that starts at a vertex has no length left."""
    one = front.vertices[start]
    other = front.vertices[one.next]
    if one.state == CLOSING or other.state == CLOSING:
        return NEVER
    side = front.sides[one.right]
    rate = (one.vx - other.vx) * side.dx + (one.vy - other.vy) * side.dy
    since = max(one.born, other.born)
    length = (x_at(other, since) - x_at(one, since)) * side.dx + (y_at(other, since) - y_at(one, since)) * side.dy
    drift = one.drift + other.drift
    if rate <= drift:
        if rate > -drift and length < FAR * (rate + drift):
            front.counts[UNSURE] = 1
        return NEVER
    time = since + length / rate
    return max(time, front.numbers[NOW]) if time <= LATEST else NEVER


@inlined
def time_of_hit(front, vertex, start, latest):
    """Return when a reflex vertex hits the fragment that starts at another; ``NEVER`` if not before ``latest``.

    This is asked most of all, so what is seldom needed is computed last.
    """
    moving, one = front.vertices[vertex], front.vertices[start]
    if one.right == moving.left or one.right == moving.right:
        return NEVER
    side = front.sides[one.right]
    rate = 1 + side.dy * moving.vx - side.dx * moving.vy
    if rate <= moving.drift or (start == moving.passed and one.next == moving.passed_end):
        return NEVER
    gap = side.dx * (moving.y - side.oy) - side.dy * (moving.x - side.ox) - moving.born
    if not gap < (latest - moving.born) * rate:
        return NEVER
    now = front.numbers[NOW]
    time = moving.born + gap / rate
    if time < now and time < now - slack(moving, now, rate):
        return NEVER  # it is behind the fragment
    other = front.vertices[one.next]
    if (one.node == moving.node or other.node == moving.node) and time <= moving.born + slack(moving, now, rate):
        return NEVER  # all this was born at one node
    if one.state == CLOSING or other.state == CLOSING:
        return NEVER
    time = max(time, now)
    x, y = x_at(moving, time), y_at(moving, time)
    along = (x - x_at(one, time)) * side.dx + (y - y_at(one, time)) * side.dy
    if along < 0 and along < -spread(moving, time) - spread(one, time):
        return NEVER
    along = (x_at(other, time) - x) * side.dx + (y_at(other, time) - y) * side.dy
    if along < 0 and along < -spread(moving, time) - spread(other, time):
        return NEVER
    return time


@compiled
def slack(moving, now, rate):
    """Return how uncertain the time of a hit is, if the vertex comes nearer to the fragment at this rate."""
    error = SAFETY * (moving.error + moving.drift * abs(now - moving.born)) / rate
    return min(error, MOST_ERROR * (1 + now))


@inlined
def consider(front, vertex, start):
    """Take a fragment as what a reflex vertex hits next, if that is earlier than what is known."""
    moving = front.vertices[vertex]
    time = time_of_hit(front, vertex, start, moving.hits)
    if time <= front.numbers[END] and time < moving.hits:
        moving.hits = time
        moving.target = start
        moving.target_end = front.vertices[start].next
        if time < moving.key:
            moving.key = time
            rise(front, vertex)


@compiled
def look_for_hit(front, vertex):
    """Find what a reflex vertex hits next."""
    front.vertices[vertex].hits = NEVER
    set_next_event(front, vertex)
    if front.counts[GRID] > 0:
        enter_vertex(front, vertex, False)
        return
    for place in range(front.counts[LIVING]):
        consider(front, vertex, front.slots[place].live)


@compiled
def fragment_changed(front, start):
    """Find when the fragment from a vertex to the next shrinks to nothing, and which reflex vertices hit it before."""
    one, end = front.vertices[start], front.vertices[start].next
    if one.state == CLOSING:
        return
    one.shrinks = time_of_shrinking(front, start)
    set_next_event(front, start)
    if front.vertices[end].state == CLOSING:
        return
    if front.counts[GRID] > 0:
        enter_fragment(front, start)
        for vertex in (start, end):  # its path may have got longer
            if front.vertices[vertex].state == REFLEX and end_of_path(front, vertex) > front.vertices[vertex].entered:
                enter_vertex(front, vertex, True)
        return
    for place in range(front.counts[LIVING]):
        vertex = front.slots[place].live
        if front.vertices[vertex].state == REFLEX:
            consider(front, vertex, start)


# What meets at one place


@inlined
def is_near(front, vertex, time, x, y, away):
    """Return whether a vertex is at a place at a time; ``away`` is how uncertain the place is."""
    distance = distance_at(front.vertices[vertex], time, x, y)
    if distance > away + spread(front.vertices[vertex], time):
        return False
    must_be_sure(front, distance, time)
    return True


@inlined
def must_be_sure(front, distance, time):
    """Note if places that were taken as the same are farther apart than rounding explains, or a place is uncertain."""
    if distance > SURE * front.numbers[NOISE] * (1 + time):
        front.counts[UNSURE] = 1


@inlined
def join(front, vertex):
    """Add a vertex to those that meet."""
    if front.vertices[vertex].mark != front.counts[MEETINGS]:
        front.vertices[vertex].mark = front.counts[MEETINGS]
        front.slots[front.counts[GROUP]].group = vertex
        front.counts[GROUP] += 1


@compiled
def meet(front, time, x, y, away, through):
    """Let all that is at one place at a time meet there: the joined vertices, and those beside them.

    ``away`` is how uncertain the place is; ``through`` the start of a fragment that passes through it, or -1.
    """
    counts = front.counts
    meeting = counts[MEETINGS]
    node = join_born_here(front, time, x, y, away)
    k = 0
    while k < counts[GROUP]:
        joined = front.vertices[front.slots[k].group]
        k += 1
        for other in (joined.prev, joined.next):
            if front.vertices[other].mark != meeting and is_near(front, other, time, x, y, away):
                join(front, other)
    if through >= 0:
        hit_one = front.vertices[through]
        if hit_one.mark == meeting or front.vertices[hit_one.next].mark == meeting:
            through = -1
    if node < 0:
        node = new_node(front, time, x, y, away, through)

    rays = 0
    for k in range(counts[GROUP]):
        joined = front.vertices[front.slots[k].group]
        if front.vertices[joined.prev].mark != meeting:
            rays = new_ray(front, rays, joined.left, joined.prev, 0)
        if front.vertices[joined.next].mark != meeting:
            rays = new_ray(front, rays, joined.right, joined.next, 1)
    if through >= 0:
        hit_one = front.vertices[through]
        rays = new_ray(front, rays, hit_one.right, through, 0)
        rays = new_ray(front, rays, hit_one.right, hit_one.next, 1)
    for k in range(counts[GROUP]):
        end_vertex(front, front.slots[k].group, node)
    if rays > 0:
        pair_rays(front, rays, node, through)


@inlined
def new_ray(front, rays, side, far, is_leaving):
    """Add the end of a fragment at a meeting: its side, the vertex at its other end; return how many there are now."""
    ray = front.rays[rays]
    ray.side, ray.far, ray.out = side, far, is_leaving
    return rays + 1


@compiled
def sort_rays(front, rays):
    """Sort the ends of fragments at a node by angle, counter-clockwise from one that leaves it.

    At the same angle, what leaves comes before what arrives: two sides that lie on each other, with nothing between.
    """
    first = 0
    while front.rays[first].out == 0:
        first += 1
    base = front.sides[front.rays[first].side]
    tie = ULP
    for k in range(rays):
        tie = max(tie, front.sides[front.rays[k].side].turn)
    tie *= 2 * SAFETY
    for k in range(rays):
        ray = front.rays[k]
        side = front.sides[ray.side]
        sign = 1 if ray.out == 1 else -1
        cosine, sine = base.dx * side.dx + base.dy * side.dy, base.dx * side.dy - base.dy * side.dx
        angle = quarter_turns(sign * cosine, sign * sine)
        if angle > 4 - tie:
            angle -= 4
        if k == first:
            angle = 0
        ray.angle = angle
        place = k
        while place > 0:
            before = front.rays[front.slots[place - 1].order]
            gap = angle - before.angle
            if gap > tie or (gap >= -tie and before.out >= ray.out):
                break
            front.slots[place].order = front.slots[place - 1].order
            place -= 1
        front.slots[place].order = k


@compiled
def pair_rays(front, rays, node, through):
    """Join each fragment that leaves a node to the one that arrives next to it, counter-clockwise.

    If the fragment that passes ``through`` the node stays whole, it was not hit but passed, as far as doubles tell.
    """
    passed_end = front.vertices[through].next if through >= 0 else -1
    sort_rays(front, rays)
    # as with brackets: what leaves opens one, what arrives closes the last that is open
    depth = 0
    made = 0
    for turn in range(2 * rays):
        k = front.slots[turn % rays].order
        if front.rays[k].out == 1:
            if turn < rays:
                front.slots[depth].stack = k
                depth += 1
        elif front.rays[k].out == 0 and depth > 0:
            depth -= 1
            other = front.slots[depth].stack
            front.rays[k].out = -1
            if front.rays[k].side == front.rays[other].side:  # what was between two parts of a fragment is gone
                link(front, front.rays[k].far, front.rays[other].far)
                front.slots[made].group = front.rays[k].far
            else:
                front.slots[made].group = new_pair(front, other, k, node)
            made += 1
    if through >= 0 and front.vertices[through].next == passed_end:
        front.counts[UNSURE] = 1
        for k in range(made):
            front.vertices[front.slots[k].group].passed = through
            front.vertices[front.slots[k].group].passed_end = passed_end
    for k in range(made):
        vertex = front.slots[k].group
        before = front.vertices[vertex].prev
        if front.vertices[vertex].node != node:  # an old vertex, whose fragment is longer now
            fragment_changed(front, vertex)
        elif front.vertices[vertex].state == CLOSING:
            front.vertices[vertex].shrinks = front.numbers[NOW]
            set_next_event(front, vertex)
            if front.vertices[before].state != CLOSING:
                front.vertices[before].shrinks = NEVER
                set_next_event(front, before)
        else:
            fragment_changed(front, before)
            fragment_changed(front, vertex)
    for k in range(made):
        vertex = front.slots[k].group
        if front.vertices[vertex].state == REFLEX and front.vertices[vertex].node == node:
            if front.counts[GRID] > 0:
                enter_vertex(front, vertex, True)
            else:
                look_for_hit(front, vertex)


@inlined
def quarter_turns(cosine, sine):
    """Return a measure of an angle from 0 to 4, which grows with it."""
    if sine >= 0:
        return sine / (sine + cosine) if cosine >= 0 else 1 - cosine / (sine - cosine)
    return 2 + sine / (sine + cosine) if cosine < 0 else 3 + cosine / (cosine - sine)


@inlined
def link(front, before, after):
    """Let one vertex follow another."""
    front.vertices[before].next = after
    front.vertices[after].prev = before


@compiled
def new_pair(front, leaving, arriving, node):
    """Return a new vertex between a fragment that arrives at a node and one that leaves it."""
    vertex = new_vertex(front, front.rays[arriving].side, front.rays[leaving].side, node, False)
    before, after = front.rays[arriving].far, front.rays[leaving].far
    link(front, before, vertex)
    link(front, vertex, after)
    if before == after and front.vertices[vertex].state != CLOSING:
        make_closing(front, vertex)
    return vertex


@inlined
def bucket_of(front, column, row):
    """Return the bucket of a small square of the plane."""
    return (column * 73856093 ^ row * 19349663) & (len(front.buckets) - 1)


@inlined
def square_of(place):
    """Return the column or row of small squares that a place is in."""
    return floor(place / SQUARE)


@compiled
def join_born_here(front, time, x, y, away):
    """Join what was born just now at this place, in a meeting before; return its node, or -1 if there is none."""
    found = -1
    away = min(away, SQUARE / 4)
    first_row, last_row = square_of(y - away), square_of(y + away)
    for column in range(square_of(x - away), square_of(x + away) + 1):
        for row in range(first_row, last_row + 1):
            node = front.buckets[bucket_of(front, column, row)]
            while node >= 0:
                known = front.nodes[node]
                dx, dy = known.x - x, known.y - y
                near = away + SAFETY * known.error
                if (
                    dx * dx + dy * dy <= near * near
                    and abs(known.time - time) <= near
                    and known.same_as == node
                    and node != found
                ):
                    must_be_sure(front, sqrt(dx * dx + dy * dy), time)
                    if found >= 0:
                        front.nodes[max(node, found)].same_as = min(node, found)
                    found = node if found < 0 else min(node, found)
                    vertex = known.born
                    while vertex >= 0:
                        if front.vertices[vertex].state != DEAD:
                            join(front, vertex)
                        vertex = front.vertices[vertex].sibling
                node = known.beside
    return found


@compiled
def new_node(front, time, x, y, away, through):
    """Return a new node where a group meets."""
    node = front.counts[NODES]
    if node >= len(front.nodes):
        front.counts[STATUS] = NO_ROOM
        return 0
    front.counts[NODES] = node + 1
    new = front.nodes[node]
    new.same_as = node
    new.born = -1
    place_node(front, node, time, x, y, away, through)
    bucket = bucket_of(front, square_of(new.x), square_of(new.y))
    new.beside = front.buckets[bucket]
    front.buckets[bucket] = node
    return node


@compiled
def place_node(front, node, time, x, y, away, through):
    """Put a node where it is equally far from its sides, by least squares, near to the place where it was found.

    Each side weighs by how certain its line is there, and so does the place itself, for directions in which the sides
    do not tell.
    """
    noise = front.numbers[NOISE]
    meeting = front.counts[MEETINGS]
    found_x, found_y, found_time = x, y, time
    prior = noise / max(away / SAFETY, noise)
    prior = prior * prior
    error = 0
    for _ in range(2):
        xx, xy, xt, yy, yt, tt = prior, 0, 0, prior, 0, prior
        fx, fy, ft = 0, 0, 0
        count = front.counts[GROUP]
        for k in range(2 * count + 1):
            # the sides that arrive at the vertices, those that leave and go on, and the one that is hit
            if k == 2 * count:
                if through < 0:
                    break
                number = front.vertices[through].right
            else:
                joined = front.vertices[front.slots[k >> 1].group]
                if k & 1 == 1 and front.vertices[joined.next].mark == meeting:
                    continue
                number = joined.left if k & 1 == 0 else joined.right
            side = front.sides[number]
            nx, ny = -side.dy, side.dx
            rx, ry = x - side.ox, y - side.oy
            off = nx * rx + ny * ry - time
            weight = noise / (noise * (1 + time) + side.turn * sqrt(rx * rx + ry * ry))
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
        error = 1 / xx + (1 + b * b) / p + (1 + q * q + e * e) / r
    placed = front.nodes[node]
    if max(abs(x - found_x), abs(y - found_y), abs(time - found_time)) > 8 * (away + noise * (1 + time)):
        front.counts[UNSURE] = 1  # the lines of the sides do not meet there
    placed.x, placed.y, placed.time = x, y, time
    placed.error = noise * sqrt(error)
    must_be_sure(front, placed.error / SAFETY, time)


@compiled
def new_meeting(front):
    """Begin a meeting that nothing has joined yet."""
    front.counts[MEETINGS] += 1
    front.counts[GROUP] = 0


@compiled
def meet_at_vertex(front, vertex, other, through, time):
    """Let a vertex, and another or a fragment that it hits, meet where the more certain of the two vertices is."""
    new_meeting(front)
    join(front, vertex)
    sure = front.vertices[vertex]
    away = spread(sure, time)
    if other >= 0:
        join(front, other)
        away = max(away, spread(front.vertices[other], time))
        if spread(front.vertices[other], time) < spread(sure, time):
            sure = front.vertices[other]
    meet(front, time, x_at(sure, time), y_at(sure, time), away, through)


@compiled
def hit(front, vertex, time):
    """Let a reflex vertex hit its fragment, or one of the fragment's ends."""
    moving = front.vertices[vertex]
    start, end = moving.target, moving.target_end
    if front.vertices[start].state == DEAD or front.vertices[start].next != end:
        look_for_hit(front, vertex)
        return
    x, y, near = x_at(moving, time), y_at(moving, time), spread(moving, time)
    for other in (start, end):
        if is_near(front, other, time, x, y, near):
            meet_at_vertex(front, vertex, other, -1, time)
            return
    meet_at_vertex(front, vertex, -1, start, time)


@compiled
def close(front, vertex, time):
    """Let two sides that lie on each other end: as far as to the nearer of their other ends, they are done."""
    closing = front.vertices[vertex]
    to_before = distance_at(front.vertices[closing.prev], time, closing.x, closing.y)
    to_after = distance_at(front.vertices[closing.next], time, closing.x, closing.y)
    nearer = closing.next if to_after <= to_before else closing.prev
    new_meeting(front)
    join(front, nearer)
    join(front, vertex)
    there = front.vertices[nearer]
    meet(front, time, x_at(there, time), y_at(there, time), spread(there, time), -1)


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
        front.vertices[front.slots[place].live].hits = NEVER
        set_next_event(front, front.slots[place].live)
    start = max(numbers[NOW], numbers[END])
    numbers[NOW] = start
    if count <= (FEW if start < LATE else FEW_LATE):
        counts[GRID] = 0
        numbers[END] = LATEST
        for place in range(count):
            vertex = front.slots[place].live
            if front.vertices[vertex].state == REFLEX:
                look_for_hit(front, vertex)
        return
    low_x, low_y, high_x, high_y = NEVER, NEVER, -NEVER, -NEVER
    for place in range(count):
        moving = front.vertices[front.slots[place].live]
        x, y = x_at(moving, start), y_at(moving, start)
        low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
    most = 1.0 + 1.5 * start  # few vertices are so fast that they get farther
    low_x, low_y, high_x, high_y = max(low_x, -most), max(low_y, -most), min(high_x, most), min(high_y, most)
    grid = 1
    widest = int(sqrt(float(len(front.cells))) + 0.5)
    while grid * grid < 4 * count and grid < widest:
        grid += 1
    counts[GRID] = grid
    size = max(high_x - low_x, high_y - low_y) + ULP
    numbers[LOW_X], numbers[LOW_Y] = low_x, low_y
    numbers[WIDTH] = (high_x - low_x + MOST_ERROR * size) / grid
    numbers[HEIGHT] = (high_y - low_y + MOST_ERROR * size) / grid
    happened = counts[MEETINGS] - counts[MEETINGS_BEFORE]
    counts[MEETINGS_BEFORE] = counts[MEETINGS]
    if happened * 16 < count and counts[FULL] == 0:
        numbers[REACH] *= 2.0
    fill_window(front, start, size / grid)
    while counts[FULL] == 1:
        numbers[REACH] *= 0.5
        if numbers[REACH] < LEAST_REACH:
            counts[STATUS] = NO_ROOM
            return
        fill_window(front, start, size / grid)


@compiled
def fill_window(front, start, cell_size):
    """Enter all fragments and reflex vertices into the grid, for as long a time as the window's reach says."""
    counts, numbers = front.counts, front.numbers
    numbers[END] = min(start + numbers[REACH] * cell_size, LATEST)
    counts[ENTRIES_USED] = 0
    counts[FULL] = 0
    for cell in range(counts[GRID] * counts[GRID]):
        front.cells[cell].fragments = -1
        front.cells[cell].vertices = -1
    for place in range(counts[LIVING]):
        enter_fragment(front, front.slots[place].live)
        if counts[FULL] == 1:
            return
    for place in range(counts[LIVING]):
        if front.vertices[front.slots[place].live].state == REFLEX:
            enter_vertex(front, front.slots[place].live, True)
            if counts[FULL] == 1:
                return


@compiled
def enter_fragment(front, start):
    """Enter a fragment into the cells that it passes, and see which reflex vertices there hit it."""
    numbers = front.numbers
    begin = numbers[NOW]
    one = front.vertices[start]
    other, side = front.vertices[one.next], front.sides[one.right]
    stop = max(min(numbers[END], one.shrinks), begin)
    dx, dy = side.dx, side.dy
    ox, oy = side.ox - begin * dy, side.oy + begin * dx
    low, high = NEVER, -NEVER
    for time in (begin, stop):
        for moving in (one, other):
            along = (x_at(moving, time) - ox) * dx + (y_at(moving, time) - oy) * dy
            low, high = min(low, along), max(high, along)
    ahead = stop - begin
    enter(front, start, ox + low * dx, oy + low * dy, ox + high * dx, oy + high * dy, -ahead * dy, ahead * dx, 0)


@inlined
def end_of_path(front, vertex):
    """Return until when a reflex vertex's path matters: to the window's end, or until a fragment beside it is gone."""
    before = front.vertices[front.vertices[vertex].prev].shrinks
    return min(front.numbers[END], front.vertices[vertex].shrinks, before)


@compiled
def enter_vertex(front, vertex, stays):
    """See which fragments a reflex vertex hits in the cells that it passes; enter it there if it ``stays``."""
    numbers = front.numbers
    moving = front.vertices[vertex]
    stop = end_of_path(front, vertex)
    if stays:
        moving.entered = stop
    x, y = x_at(moving, numbers[NOW]), y_at(moving, numbers[NOW])
    ahead = max(stop - numbers[NOW], 0.0)
    enter(front, vertex, x, y, x + ahead * moving.vx, y + ahead * moving.vy, 0.0, 0.0, 2 if stays else 1)


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


@inlined
def cell_of(place, grid):
    """Return the column or row of cells that a place, in cells, is in."""
    if not place > 0.0:
        return 0
    return int(place) if place < grid else grid - 1


@inlined
def visit(front, cell, item, kind):
    """Compare a fragment with the vertices of a cell, or a vertex with its fragments, and enter it there."""
    entry = front.cells[cell].vertices if kind == 0 else front.cells[cell].fragments
    while entry >= 0:
        other = front.entries[entry].item
        if kind == 0:
            if front.vertices[other].state == REFLEX:
                consider(front, other, item)
        elif front.vertices[other].state != DEAD:
            consider(front, item, other)
        entry = front.entries[entry].next
    if kind == 1:
        return
    entry = front.counts[ENTRIES_USED]
    if entry >= len(front.entries):
        front.counts[FULL] = 1
        return
    front.counts[ENTRIES_USED] = entry + 1
    front.entries[entry].item = item
    if kind == 0:
        front.entries[entry].next = front.cells[cell].fragments
        front.cells[cell].fragments = entry
    else:
        front.entries[entry].next = front.cells[cell].vertices
        front.cells[cell].vertices = entry


# From the start to the end


@compiled
def start(front, sides, x, y, noise):
    """Set the wavefront of a graph on its points: it has a vertex at the head of every side."""
    counts, numbers = front.counts, front.numbers
    for k in range(len(counts)):
        counts[k] = 0
        numbers[k] = 0
    numbers[NOISE] = noise
    numbers[REACH] = FIRST_REACH
    for point in range(len(x)):
        node = front.nodes[point]
        node.x, node.y, node.time, node.error = x[point], y[point], 0, noise
        node.same_as, node.born = point, -1
    counts[NODES] = len(x)
    for bucket in range(len(front.buckets)):
        front.buckets[bucket] = -1
    count = len(sides.tail)
    for side in range(count):
        source = sides.source[side]
        tail, head = sides.tail[source], sides.head[source]
        dx, dy = x[head] - x[tail], y[head] - y[tail]
        length = sqrt(dx * dx + dy * dy)
        new = front.sides[side]
        new.dx, new.dy = dx / length, dy / length
        if source != side:
            new.dx, new.dy = new.dy, -new.dx
        new.ox, new.oy = x[sides.tail[side]], y[sides.tail[side]]
        new.turn = noise / length
    for side in range(count):
        new_vertex(front, side, sides.following[side], sides.head[side], True)
    for side in range(count):
        link(front, side, sides.following[side])
    for vertex in range(count):
        front.vertices[vertex].shrinks = time_of_shrinking(front, vertex)
        set_next_event(front, vertex)
    open_window(front)


@compiled
def run(front, sides, x, y, noise):
    """Move the wavefront of a graph from the points with these coordinates to its end; return the status.

    ``noise`` is the rounding of the coordinates, which must be within -1 and 1.
    """
    start(front, sides, x, y, noise)
    counts, numbers = front.counts, front.numbers
    most = 8 * len(sides.tail) + 256
    while counts[WAITING] > 0 and counts[STATUS] == DONE:
        vertex = front.slots[0].heap
        moving = front.vertices[vertex]
        if counts[FULL] == 1:
            numbers[END] = numbers[NOW]
            open_window(front)
            continue
        if moving.key > numbers[END]:
            if numbers[END] >= LATEST:
                break
            open_window(front)
            continue
        time = max(numbers[NOW], moving.key)
        numbers[NOW] = time
        if moving.state == CLOSING:
            close(front, vertex, time)
        elif moving.shrinks <= moving.hits:
            meet_at_vertex(front, vertex, moving.next, -1, time)
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
        vertex = front.slots[place].live
        front.vertices[vertex].target = new_arc(front, vertex, -1)
    for place in range(front.counts[LIVING]):
        vertex = front.slots[place].live
        front.arcs[front.vertices[vertex].target].beyond = front.vertices[front.vertices[vertex].prev].target


@compiled
def join_near_nodes(front, near):
    """Join nodes no farther apart than this, in place and time, if there is an arc between them."""
    for arc in range(front.counts[ARCS]):
        if front.arcs[arc].end >= 0:
            first, last = root(front, front.arcs[arc].start), root(front, front.arcs[arc].end)
            one, other = front.nodes[first], front.nodes[last]
            off = max(abs(one.x - other.x), abs(one.y - other.y), abs(one.time - other.time))
            if off <= near * (1 + one.time):
                front.nodes[max(first, last)].same_as = min(first, last)


@compiled
def gather_faces(front, sides, faces):
    """Put the nodes of every face in order, counter-clockwise from its side's tail; -1 for the infinite.

    Half-edge 2k runs along arc k with the face on its left, 2k + 1 against it. Returns False where half-edges do not
    make one outline. Notes if a face is not monotone: then doubles were not precise enough.
    """
    count = len(sides.tail)
    for side in range(count):
        faces.sides[side].first = -1
    for node in range(front.counts[NODES]):
        faces.items[node].face = -1
    for number in range(front.counts[ARCS]):
        arc = front.arcs[number]
        arc.start = root(front, arc.start)
        if arc.end >= 0:
            arc.end = root(front, arc.end)
        if arc.start != arc.end:
            add_half_edge(faces, arc.left, 2 * number)
            add_half_edge(faces, arc.right, 2 * number + 1)
    filled = 0
    for side in range(count):
        faces.sides[side].offset = filled
        half_edges = find_half_edges(front, faces, side)
        if half_edges < 0:
            return False
        way = FORTH
        tail, node = sides.tail[side], sides.head[side]
        if tail != node:
            faces.items[filled].value = tail
            filled += 1
        while True:
            faces.items[filled].value = node
            filled += 1
            if faces.items[node].face != side:
                return False
            half = faces.items[node].at_node
            half_edges -= 1
            arc = front.arcs[half >> 1]
            before, node = node, arc.end if half & 1 == 0 else arc.start
            if node < 0:
                faces.items[filled].value = -1
                filled += 1
                half_edges -= 1
                back = front.arcs[arc.beyond]
                node = back.start
                way = way_after(front, way, side, arc.vx, arc.vy, PARALLEL * (1 + abs(arc.vx) + abs(arc.vy)))
                way = way_after(front, way, side, back.vx - arc.vx, back.vy - arc.vy, PARALLEL)
                way = way_after(front, way, side, -back.vx, -back.vy, PARALLEL * (1 + abs(back.vx) + abs(back.vy)))
            else:
                one, other = front.nodes[before], front.nodes[node]
                near = 4 * SURE * front.numbers[NOISE] * (1 + one.time + other.time)
                way = way_after(front, way, side, other.x - one.x, other.y - one.y, near)
            if way == WRONG:
                front.counts[WRONG_FACES] = 1
            if node == tail:
                break
            if half_edges <= 0:
                return False
        if half_edges != 0:
            return False
    faces.sides[count].offset = filled
    return True


@inlined
def way_after(front, way, side, dx, dy, near):
    """Return which way a face's outline goes along its side after a step by (dx, dy): forth, back, and forth again.

    Anything else is wrong: faces are monotone. Steps no longer than ``near`` do not count.
    """
    along = dx * front.sides[side].dx + dy * front.sides[side].dy
    if along > near and way == BACK:
        return FORTH_AGAIN
    if along < -near and way == FORTH:
        return BACK
    if along < -near and way == FORTH_AGAIN:
        return WRONG
    return way


@compiled
def add_half_edge(faces, side, half):
    """Add a half-edge to those of a side's face."""
    faces.items[half].following = faces.sides[side].first
    faces.sides[side].first = half


@compiled
def find_half_edges(front, faces, side):
    """Note for each node of a face the half-edge that leaves it; return how many half-edges there are.

    -1 if two leave the same node.
    """
    count = 0
    half = faces.sides[side].first
    while half >= 0:
        arc = front.arcs[half >> 1]
        node = arc.start if half & 1 == 0 else arc.end
        if node >= 0:
            if faces.items[node].face == side:
                return -1
            faces.items[node].face = side
            faces.items[node].at_node = half
        count += 1
        half = faces.items[half].following
    return count
