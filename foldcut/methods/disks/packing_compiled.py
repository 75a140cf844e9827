"""Filling a gap of one chain with compiled code: what ``dividing`` does, in near-linear time.

One chain of disks that touch in a row -> the disks to add, and the gaps of 3 or 4 sides. It makes the same choices as
``dividing`` and does the same arithmetic in the same order, so every bit of the result is the same. Only the data
structures differ:

- a chain is a ring of linked *visits*; a new disk cuts and joins the rings where it touches, whatever their length;
- the disks are in a quadtree: a disk is in the cell of its own size that contains its centre, and each cell knows the
  bounds of its contents. The disk that rolls in from a leaf is looked for in circles that grow until something is met,
  and shrink as more is met;
- the rolled disks are in a second quadtree, so that a new disk finds those that it blocks. The next disk of such a leaf
  is the one that touches the new disk: nothing else has been added, so nothing is searched;
- the rolled disks of each gap are in a skew heap (which needs no sizes), the largest first. When a gap is divided, its
  largest part keeps the heap, and only the disks of the other parts are sorted anew.

It imports numba, so it is imported only where there are many disks: importing it takes a third of a second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba.extending import intrinsic
from numpy.typing import NDArray

from foldcut.core.arrays import Floats, Ints
from foldcut.core.compiled import compiler
from foldcut.methods.disks.chains import TURN, StuckError

try:  # parts of numba that it may change without notice
    from numba.core import cgutils
    from numba.core.imputils import impl_ret_borrowed
except ImportError:
    cgutils = impl_ret_borrowed = None

__all__ = ["Filled", "GapFiller", "uncounted"]

Indices = NDArray[np.int32]
Numbers = NDArray[np.int64]
Table = NDArray[np.void]

# --- the places in ``_State.counts``

DISKS = 0
"""Disks there are."""
VISITS = 1
"""Visits made so far."""
NODES = 2
"""Cells of both trees."""
ENTRIES = 3
"""Heap entries made so far."""
FREE = 4
"""The first of the heap entries to use again, which are linked by ``left``; -1 for none."""
FREED = 5
"""How many heap entries there are to use again."""
GAPS = 6
"""Gaps numbered so far."""
STACK = 7
"""Gaps that are not finished."""
OUT = 8
"""Finished gaps."""
OUT_VALUES = 9
"""Disks of the finished gaps."""
CONTACTS = 10
"""What the disk that is tried touches."""
BLOCKED = 11
"""Leaves whose disk the newest disk blocks."""

# --- the places in ``_State.limits`` and ``_State.found``, and the columns of ``_State.bounds``

MIDDLE_X = 0
"""The middle of the root cell."""
MIDDLE_Y = 1
"""The middle of the root cell."""
HALF = 2
"""Half the width of the root cell."""
TIE = 3
"""``Tolerance.tie``."""
ROUNDING = 4
"""``Tolerance.rounding``."""
NEARLY = 5
"""``dividing.NEARLY``."""
EQUAL = 6
"""``rolling.EQUAL``."""
X = 0
"""The found disk's centre."""
Y = 1
"""The found disk's centre."""
R = 2
"""The found disk's radius."""
LOW_X = 0
"""The least x of all that was ever put into a cell or its children."""
LOW_Y = 1
"""The least y."""
HIGH_X = 2
"""The greatest x."""
HIGH_Y = 3
"""The greatest y."""

# --- the status of a leaf's disk

UNKNOWN = 0
"""It has not been rolled, or a new disk blocks it."""
ROLLED = 1
"""It is known and may help."""
EAR = 2
"""It is known and does not help."""
NONE = 3
"""No disk rolls in."""

# --- what ``_run`` and ``_divide`` return

DONE = 0
"""No gap is left."""
GO_ON = 1
"""There is more to divide."""
GROW = 2
"""The arrays need more room first."""
STUCK = 3
"""Nothing divides the gap on top of the stack."""

# --- what ``_try`` returns

FAILS = 0
"""The disk overlaps another one, or is an ear."""
HELPS = 1
"""The disk helps."""
NEARLY_TOUCHES = 2
"""The disk helps, but nearly touches one more disk."""

# --- sizes

DISK_ROOT = 0
"""The root cell of the disks' tree."""
ROLLED_ROOT = 1
"""The root cell of the rolled disks' tree."""
DEEPEST = 48
"""Levels of a tree; each halves the width of the cells."""
AT_ONCE = 20_000
"""Divisions between two reports."""


class _State(NamedTuple):
    """All arrays; the first five are structured."""

    disks: Table
    visits: Table
    entries: Table
    gaps: Table
    contacts: Table
    child: Indices  # (cells, 4)
    first: Indices  # the first item of the cell
    bounds: Floats  # (cells, 4), columns LOW_X to HIGH_Y
    stack: Indices  # of gaps
    group: Indices  # of visits, like aside and blocked
    aside: Indices
    blocked: Indices
    out_offsets: Indices
    out_values: Indices
    counts: Numbers  # places DISKS to BLOCKED
    limits: Floats  # places MIDDLE_X to EQUAL
    found: Floats  # places X, Y, R
    path: Indices


class Filled(NamedTuple):
    """The new disks, and the finished gaps: the disks of all, and where each begins and ends."""

    centres: Floats
    radii: Floats
    values: Ints
    offsets: Ints


DISK = np.dtype([("x", "f8"), ("y", "f8"), ("r", "f8"), ("following", "i4"), ("first_visit", "i4")])
"""A disk; ``following`` is the next disk in its cell."""

VISIT = np.dtype(
    [
        ("rolled_x", "f8"),
        ("rolled_y", "f8"),
        ("rolled_r", "f8"),
        *((name, "i4") for name in ("disk", "after", "before", "gap", "same", "status", "version")),
        *((name, "i4") for name in ("cell", "cell_next", "cell_before")),
    ],
    align=True,
)
"""A visit. ``after`` and ``before``: its neighbours in the chain; ``same``: the next visit to the same disk. The rest
describes the leaf from this visit to the one after: the disk that rolled in, its status, and its place in its tree."""

ENTRY = np.dtype([("r", "f8"), ("visit", "i4"), ("version", "i4"), ("left", "i4"), ("right", "i4")], align=True)
"""An entry of a heap; it counts only while the visit still has the same version."""

GAP = np.dtype([("head", "i4"), ("length", "i4"), ("heap", "i4")])
"""A gap: one of its visits, how many it has, and the root of its heap."""

CONTACT = np.dtype([("angle", "f8"), ("disk", "i4"), ("visit", "i4")])
"""What the disk that is tried touches."""

GROUPS = (
    ("disks",),
    ("visits", "group", "aside", "blocked"),
    ("first", "child", "bounds"),
    ("entries",),
    ("gaps",),
    ("stack",),
    ("out_offsets",),
    ("out_values",),
    ("contacts",),
)
"""Arrays that have the same length."""

TYPES = {"disks": DISK, "visits": VISIT, "entries": ENTRY, "gaps": GAP, "contacts": CONTACT, "bounds": np.float64}
"""The types of arrays that are not int32."""

_compiled = compiler()(cache=True, error_model="numpy", nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
_called = compiler()(cache=True, error_model="numpy", nogil=True, no_cfunc_wrapper=True)


def _build_uncounted(context, builder, signature, values):
    arrays = []
    for kind, value in zip(signature.return_type, cgutils.unpack_tuple(builder, values[0]), strict=True):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        arrays.append(array._getvalue())
    return context.make_tuple(builder, signature.return_type, arrays)


@intrinsic
def _without_counts(_, state):
    """Return the state with no reference counts, or the very same one if numba's arrays are not as expected."""

    def build(context, builder, signature, values):
        try:
            return _build_uncounted(context, builder, signature, values)
        except (AttributeError, TypeError, NotImplementedError):
            return impl_ret_borrowed(context, builder, signature.return_type, values[0])

    return state(state), build


def _same(state):
    return state


uncounted = _compiled(_same) if cgutils is None else _without_counts
"""In compiled code: a state whose arrays have no reference counts, for counting takes nearly as long as all the rest.

It depends on how numba lays out arrays. Where numba does that otherwise, the state keeps its counts: slower, and right.
"""


# --- the trees


@_compiled
def _cell(s, root, x, y, r):
    """Return the cell for a circle; make it if there is none."""
    node, middle_x, middle_y, half = root, s.limits[MIDDLE_X], s.limits[MIDDLE_Y], s.limits[HALF]
    if abs(x - middle_x) > half or abs(y - middle_y) > half:
        return node
    for _ in range(DEEPEST):
        half *= 0.5
        if half < r:
            break
        quarter = 0
        if x >= middle_x:
            quarter = 1
            middle_x += half
        else:
            middle_x -= half
        if y >= middle_y:
            quarter += 2
            middle_y += half
        else:
            middle_y -= half
        child = s.child[node, quarter]
        if child < 0:
            child = s.counts[NODES]
            if child == len(s.first):  # a larger cell does no harm; the loop soon makes room
                break
            s.counts[NODES] += 1
            s.child[node, quarter] = child
            s.child[child, :] = -1
            s.first[child] = -1
            s.bounds[child, :2] = np.inf
            s.bounds[child, 2:] = -np.inf
        node = child
        s.bounds[node, LOW_X], s.bounds[node, LOW_Y] = (
            min(s.bounds[node, LOW_X], x - r),
            min(s.bounds[node, LOW_Y], y - r),
        )
        s.bounds[node, HIGH_X], s.bounds[node, HIGH_Y] = (
            max(s.bounds[node, HIGH_X], x + r),
            max(s.bounds[node, HIGH_Y], y + r),
        )
    return node


@_compiled
def _push_children(s, node, depth, x, y, r):
    """Push the node's children that a circle may meet onto the path; return its new length."""
    for quarter in range(4):
        child = s.child[node, quarter]
        if child < 0:
            continue
        off_x = max(s.bounds[child, LOW_X] - x, x - s.bounds[child, HIGH_X], 0.0)
        off_y = max(s.bounds[child, LOW_Y] - y, y - s.bounds[child, HIGH_Y], 0.0)
        if off_x * off_x + off_y * off_y <= r * r:
            s.path[depth] = child
            depth += 1
    return depth


@_compiled
def _start(s, root):
    s.path[0] = root
    return 1


@_compiled
def _insert_disk(s, disk):
    node = _cell(s, DISK_ROOT, s.disks.x[disk], s.disks.y[disk], s.disks.r[disk])
    s.disks.following[disk] = s.first[node]
    s.first[node] = disk


@_compiled
def _link_rolled(s, visit):
    node = _cell(s, ROLLED_ROOT, s.visits.rolled_x[visit], s.visits.rolled_y[visit], s.visits.rolled_r[visit])
    following = s.first[node]
    s.visits.cell[visit], s.visits.cell_next[visit], s.visits.cell_before[visit] = node, following, -1
    if following >= 0:
        s.visits.cell_before[following] = visit
    s.first[node] = visit


@_compiled
def _unlink_rolled(s, visit):
    before, following = s.visits.cell_before[visit], s.visits.cell_next[visit]
    if before >= 0:
        s.visits.cell_next[before] = following
    else:
        s.first[s.visits.cell[visit]] = following
    if following >= 0:
        s.visits.cell_before[following] = before


# --- rolling


@_compiled
def _height(s, k, origin_x, origin_y, along_x, along_y, middle, half_width):
    """Return how high in the strip the growing disk meets disk k; see ``GrowingDisks.roll``."""
    off_x, off_y = s.disks.x[k] - origin_x, s.disks.y[k] - origin_y
    x, y, r = off_x * along_x + off_y * along_y, off_y * along_x - off_x * along_y, s.disks.r[k]
    power = x * x + y * y - r * r
    if not power > 0:
        return -np.inf
    wide, aside = half_width + r / power, x / power - middle
    reach = wide * wide - aside * aside
    if not reach > 0:
        return -np.inf
    return y / power + math.sqrt(reach)


@_compiled
def _swept(middle, height, half_width, origin_x, origin_y, along_x, along_y):
    """Return a circle around everything that the disk has swept when it has grown to a height.

    In the strip the disk has swept everything above that height. This lies in a half-plane that does not contain the
    origin, and the half-plane is the image of the circle.
    """
    away = math.sqrt(middle * middle + height * height)
    radius = 0.5 / (away - half_width) * (1 + 1e-7)
    forward, left = middle / away * radius, height / away * radius
    return origin_x + along_x * forward - along_y * left, origin_y + along_y * forward + along_x * left, radius


@_compiled
def _roll(s, i, j, only):
    """Find the largest disk left of i -> j that touches both; ``only``: the one disk to consider, or -1 for all."""
    x_i, y_i, r_i = s.disks.x[i], s.disks.y[i], s.disks.r[i]
    x_j, y_j, r_j = s.disks.x[j], s.disks.y[j], s.disks.r[j]
    along_x, along_y = x_j - x_i, y_j - y_i
    length = math.sqrt(along_x * along_x + along_y * along_y)
    along_x, along_y = along_x / length, along_y / length
    origin_x, origin_y = x_i + along_x * r_i, y_i + along_y * r_i
    middle, half_width = (1 / r_j - 1 / r_i) / 4, (1 / r_j + 1 / r_i) / 4
    top = -np.inf
    if only >= 0:
        top = _height(s, only, origin_x, origin_y, along_x, along_y, middle, half_width)
    bound = 2 * min(r_i, r_j)
    while top == -np.inf and bound < 1e4 * s.limits[HALF]:
        share = half_width / bound
        least = math.sqrt(share + half_width * half_width - middle * middle) * (1 - 1e-9)
        x, y, radius = _swept(middle, least, half_width, origin_x, origin_y, along_x, along_y)
        depth = _start(s, DISK_ROOT)
        while depth > 0:
            depth -= 1
            node = s.path[depth]
            k = s.first[node]
            while k >= 0:
                off_x, off_y, apart = s.disks.x[k] - x, s.disks.y[k] - y, radius + s.disks.r[k]
                if off_x * off_x + off_y * off_y < apart * apart and k != i and k != j:
                    height = _height(s, k, origin_x, origin_y, along_x, along_y, middle, half_width)
                    if height > top and height > least:
                        top = height
                        if middle * middle + top * top > half_width * half_width:
                            x, y, radius = _swept(middle, top, half_width, origin_x, origin_y, along_x, along_y)
                k = s.disks.following[k]
            depth = _push_children(s, node, depth, x, y, radius)
        bound *= 3
    share = middle * middle + top * top - half_width * half_width
    if top == -np.inf or share <= 0 or top <= 0:
        return False
    forward, left = middle / share, top / share
    s.found[X] = origin_x + along_x * forward - along_y * left
    s.found[Y] = origin_y + along_y * forward + along_x * left
    s.found[R] = half_width / share
    return True


@_compiled
def _roll_leaf(s, visit, only):
    """Roll a leaf's disk, and put it into its tree and its gap's heap."""
    i, j = s.visits.disk[visit], s.visits.disk[s.visits.after[visit]]
    found = _roll(s, i, j, only)
    if not found and only >= 0:
        found = _roll(s, i, j, -1)
    s.visits.version[visit] += 1
    if not found:
        s.visits.status[visit] = NONE
        return
    s.visits.status[visit] = ROLLED
    s.visits.rolled_x[visit], s.visits.rolled_y[visit], s.visits.rolled_r[visit] = s.found[X], s.found[Y], s.found[R]
    _link_rolled(s, visit)
    _push(s, visit)


# --- the heaps


@_compiled
def _merge(s, one, other):
    if one < 0:
        return other
    if other < 0:
        return one
    if s.entries.r[other] > s.entries.r[one]:
        one, other = other, one
    root = one
    while True:
        rest = s.entries.right[one]
        s.entries.right[one] = s.entries.left[one]
        if rest < 0:
            s.entries.left[one] = other
            return root
        if s.entries.r[other] > s.entries.r[rest]:
            rest, other = other, rest
        s.entries.left[one] = rest
        one = rest


@_compiled
def _push(s, visit):
    if s.counts[FREE] >= 0:
        entry = s.counts[FREE]
        s.counts[FREE] = s.entries.left[entry]
        s.counts[FREED] -= 1
    else:
        entry = s.counts[ENTRIES]
        s.counts[ENTRIES] += 1
    s.entries.visit[entry], s.entries.version[entry] = visit, s.visits.version[visit]
    s.entries.r[entry] = s.visits.rolled_r[visit]
    s.entries.left[entry] = s.entries.right[entry] = -1
    gap = s.visits.gap[visit]
    s.gaps.heap[gap] = _merge(s, s.gaps.heap[gap], entry)


@_compiled
def _free(s, entry):
    s.entries.left[entry] = s.counts[FREE]
    s.counts[FREE] = entry
    s.counts[FREED] += 1


@_compiled
def _pop(s, gap, least):
    """Pop the leaf of the gap's largest rolled disk that is no ear; return -1 if none is as large as ``least``."""
    while s.gaps.heap[gap] >= 0:
        entry = s.gaps.heap[gap]
        visit = s.entries.visit[entry]
        stands = (
            s.visits.gap[visit] == gap
            and s.visits.status[visit] == ROLLED
            and s.visits.version[visit] == s.entries.version[entry]
        )
        if stands and s.entries.r[entry] < least:
            return -1
        s.gaps.heap[gap] = _merge(s, s.entries.left[entry], s.entries.right[entry])
        _free(s, entry)
        if stands:
            return visit
    return -1


@_compiled
def _free_heap(s, gap):
    """Free all entries, each after its children have been moved to its right."""
    entry = s.gaps.heap[gap]
    s.gaps.heap[gap] = -1
    while entry >= 0:
        left, right = s.entries.left[entry], s.entries.right[entry]
        if left >= 0:  # rotate until nothing is on the left
            s.entries.left[entry] = s.entries.right[left]
            s.entries.right[left] = entry
            entry = left
        else:
            _free(s, entry)
            entry = right


# --- trying a disk


@_compiled
def _angle(start_x, start_y, end_x, end_y):
    return math.atan2(start_x * end_y - start_y * end_x, start_x * end_x + start_y * end_y) % TURN


@_compiled
def _is_in_gap(s, disk, gap):
    visit = s.disks.first_visit[disk]
    while visit >= 0:
        if s.visits.gap[visit] == gap:
            return True
        visit = s.visits.same[visit]
    return False


@_compiled
def _visit_toward(s, gap, disk, x, y):
    """Return the visit whose sector of the gap contains the direction toward a point.

    Returns -1 if no sector contains it, -2 if the gap does not visit the disk.
    """
    best, best_outside = -2, np.inf
    centre_x, centre_y = s.disks.x[disk], s.disks.y[disk]
    visit = s.disks.first_visit[disk]
    while visit >= 0:
        if s.visits.gap[visit] == gap:
            following, before = s.visits.disk[s.visits.after[visit]], s.visits.disk[s.visits.before[visit]]
            start_x, start_y = s.disks.x[following] - centre_x, s.disks.y[following] - centre_y
            turn = _angle(start_x, start_y, x - centre_x, y - centre_y)
            sector = _angle(start_x, start_y, s.disks.x[before] - centre_x, s.disks.y[before] - centre_y)
            excess = turn - (sector if sector != 0 else TURN)
            outside = 0.0 if excess <= 0 else min(excess, TURN - turn)
            if outside < best_outside:
                best, best_outside = visit, outside
        visit = s.visits.same[visit]
    if best >= 0 and not best_outside < 1e-6:
        return -1
    return best


@_compiled
def _try(s, gap, x, y, radius):
    """Find what a disk touches, sorted by disk, and return FAILS, HELPS or NEARLY_TOUCHES."""
    tie, rounding, nearly = s.limits[TIE], s.limits[ROUNDING], s.limits[NEARLY]
    count, near = 0, False
    reach = radius * (1 + nearly) + 2 * rounding
    depth = _start(s, DISK_ROOT)
    while depth > 0:
        depth -= 1
        node = s.path[depth]
        k = s.first[node]
        while k >= 0:
            off_x, off_y, apart = s.disks.x[k] - x, s.disks.y[k] - y, reach + s.disks.r[k]
            square = off_x * off_x + off_y * off_y
            if square < apart * apart:
                slack = math.sqrt(square) - s.disks.r[k] - radius
                smaller = min(s.disks.r[k], radius)
                allowed = tie * smaller + rounding
                if slack < -allowed:
                    if _is_in_gap(s, k, gap):
                        return FAILS
                elif slack <= allowed:
                    at = count
                    if at < len(s.contacts):
                        while at > 0 and s.contacts.disk[at - 1] > k:
                            s.contacts.disk[at] = s.contacts.disk[at - 1]
                            at -= 1
                        s.contacts.disk[at] = k
                    count += 1
                elif slack < nearly * smaller and _is_in_gap(s, k, gap):
                    near = True
            k = s.disks.following[k]
        depth = _push_children(s, node, depth, x, y, reach)
    s.counts[CONTACTS] = count
    if count > len(s.contacts):
        return FAILS  # the loop makes room and tries again
    seen = 0
    for at in range(count):
        visit = _visit_toward(s, gap, s.contacts.disk[at], x, y)
        if visit == -1:
            return FAILS
        if visit >= 0:
            s.contacts.disk[seen], s.contacts.visit[seen] = s.contacts.disk[at], visit
            seen += 1
    s.counts[CONTACTS] = seen
    if seen < 3:
        return FAILS
    if seen == 3:
        for at in range(3):
            middle = s.contacts.visit[at]
            one, other = s.visits.before[middle], s.visits.after[middle]
            a, b = s.contacts.visit[(at + 1) % 3], s.contacts.visit[(at + 2) % 3]
            if (one == a and other == b) or (one == b and other == a):
                return FAILS  # an ear: a gap as large as this one would remain
    return NEARLY_TOUCHES if near else HELPS


# --- placing a disk


@_compiled
def _polish(s, x, y, radius):
    """Newton's method for the disk that touches the contacts; see ``Divider``."""
    start_x, start_y, start_radius = x, y, radius
    count = s.counts[CONTACTS]
    for _ in range(2):
        mean_u = mean_v = mean_off = 0.0
        for at in range(count):
            k = s.contacts.disk[at]
            away_x, away_y = x - s.disks.x[k], y - s.disks.y[k]
            distance = math.sqrt(away_x * away_x + away_y * away_y)
            mean_u, mean_v = mean_u + away_x / distance, mean_v + away_y / distance
            mean_off = mean_off + (radius + s.disks.r[k] - distance)
        mean_u, mean_v, mean_off = mean_u / count, mean_v / count, mean_off / count
        first = mixed = 0.0
        for at in range(count):
            k = s.contacts.disk[at]
            away_x, away_y = x - s.disks.x[k], y - s.disks.y[k]
            distance = math.sqrt(away_x * away_x + away_y * away_y)
            u, v = away_x / distance - mean_u, away_y / distance - mean_v
            first, mixed = first + u * u, mixed + u * v
        if first == 0.0:
            break
        share = mixed / first
        second = to_first = to_second = 0.0
        for at in range(count):
            k = s.contacts.disk[at]
            away_x, away_y = x - s.disks.x[k], y - s.disks.y[k]
            distance = math.sqrt(away_x * away_x + away_y * away_y)
            u, v = away_x / distance - mean_u, away_y / distance - mean_v
            off = radius + s.disks.r[k] - distance - mean_off
            rest = v - share * u
            second, to_first, to_second = second + rest * rest, to_first + u * off, to_second + rest * off
        if second == 0.0:
            break
        step_y = to_second / second
        step_x = to_first / first - share * step_y
        growth = mean_u * step_x + mean_v * step_y - mean_off
        if not max(abs(step_x), abs(step_y), abs(growth)) < 1e-3 * radius:
            break
        x, y, radius = x + step_x, y + step_y, radius + growth
    else:
        s.found[X], s.found[Y], s.found[R] = x, y, radius
        return
    s.found[X], s.found[Y], s.found[R] = start_x, start_y, start_radius


@_compiled
def _find_blocked(s, gap, x, y, radius):
    """Remove the gap's rolled disks that overlap a new disk from their tree."""
    tie, rounding = s.limits[TIE], s.limits[ROUNDING]
    count = 0
    depth = _start(s, ROLLED_ROOT)
    while depth > 0:
        depth -= 1
        node = s.path[depth]
        visit = s.first[node]
        while visit >= 0:
            following = s.visits.cell_next[visit]
            off_x, off_y, r = s.visits.rolled_x[visit] - x, s.visits.rolled_y[visit] - y, s.visits.rolled_r[visit]
            square = off_x * off_x + off_y * off_y
            if square < (r + radius) * (r + radius) and s.visits.gap[visit] == gap:
                slack = math.sqrt(square) - r - radius
                if slack < -(tie * min(r, radius) + rounding):
                    _unlink_rolled(s, visit)
                    s.visits.status[visit] = UNKNOWN
                    s.blocked[count] = visit
                    count += 1
            visit = following
        depth = _push_children(s, node, depth, x, y, radius)
    s.counts[BLOCKED] = count


@_compiled
def _new_visit(s, disk, gap):
    visit = s.counts[VISITS]
    s.counts[VISITS] += 1
    s.visits.disk[visit], s.visits.gap[visit] = disk, gap
    s.visits.status[visit], s.visits.version[visit] = UNKNOWN, 0
    s.visits.same[visit] = s.disks.first_visit[disk]
    s.disks.first_visit[disk] = visit
    return visit


@_compiled
def _place(s, gap, x, y, radius):
    """Add the disk that touches the contacts, and replace the top of the stack by the gaps around the disk."""
    _polish(s, x, y, radius)
    new = s.counts[DISKS]
    s.counts[DISKS] += 1
    x, y, radius = s.found[X], s.found[Y], s.found[R]
    s.disks.x[new], s.disks.y[new], s.disks.r[new] = x, y, radius
    s.disks.first_visit[new] = -1
    _insert_disk(s, new)
    _find_blocked(s, gap, x, y, radius)
    count = s.counts[CONTACTS]
    for at in range(count):  # counter-clockwise
        visit = s.contacts.visit[at]
        k = s.visits.disk[visit]
        angle = math.atan2(s.disks.y[k] - y, s.disks.x[k] - x)
        place = at
        while place > 0 and s.contacts.angle[place - 1] > angle:
            s.contacts.angle[place], s.contacts.visit[place] = s.contacts.angle[place - 1], s.contacts.visit[place - 1]
            place -= 1
        s.contacts.angle[place], s.contacts.visit[place] = angle, visit
    total = s.gaps.length[gap] + 2 * count
    # each contact becomes two visits: its own chain leaves from the old one and arrives at the new one
    for at in range(count):
        visit = s.contacts.visit[at]
        incoming, before, spoke = (
            _new_visit(s, s.visits.disk[visit], gap),
            s.visits.before[visit],
            _new_visit(s, new, gap),
        )
        if before == visit:
            before = incoming  # cannot be: a gap has more than four visits
        s.visits.after[before], s.visits.before[incoming] = incoming, before
        s.visits.after[incoming], s.visits.before[spoke] = spoke, incoming
        s.contacts.disk[at] = spoke
    for at in range(count):
        spoke, outgoing = s.contacts.disk[at], s.contacts.visit[at - 1 if at else count - 1]
        s.visits.after[spoke], s.visits.before[outgoing] = outgoing, spoke
    _share_out(s, gap, count, total)
    for at in range(count):
        spoke = s.contacts.disk[at]
        for visit in (spoke, s.visits.before[spoke]):
            if s.gaps.length[s.visits.gap[visit]] > 4:
                _roll_leaf(s, visit, -1)
    for at in range(s.counts[BLOCKED]):
        visit = s.blocked[at]
        if s.gaps.length[s.visits.gap[visit]] > 4:
            _roll_leaf(s, visit, new)


@_compiled
def _share_out(s, gap, count, total):
    """Number the gaps around the new disk: the largest keeps the old number and the heap.

    All gaps are walked in step, so the walk ends with the second largest.
    """
    s.counts[STACK] -= 1
    # contacts.disk now holds the new disk's visits; the part from contact ``at`` has the visit of the contact after it
    left = count
    steps = 1
    for at in range(count):
        s.aside[at] = s.visits.after[s.contacts.disk[(at + 1) % count]]
        s.group[at] = 0
    while left > 1:
        steps += 1
        for at in range(count):
            if s.group[at] == 0:
                s.aside[at] = s.visits.after[s.aside[at]]
                if s.aside[at] == s.visits.after[s.contacts.disk[(at + 1) % count]]:
                    s.group[at] = steps - 1
                    left -= 1
                    if left == 1:
                        break
    known = 0
    for at in range(count):
        known += s.group[at]
    for at in range(count):
        start = s.contacts.disk[(at + 1) % count]
        length = s.group[at] if s.group[at] > 0 else total - known
        number = gap
        if s.group[at] > 0:
            number = s.counts[GAPS]
            s.counts[GAPS] += 1
            s.gaps.heap[number] = -1
            visit = start
            while True:
                s.visits.gap[visit] = number
                if length > 4 and s.visits.status[visit] == ROLLED:
                    _push(s, visit)
                visit = s.visits.after[visit]
                if visit == start:
                    break
        s.gaps.head[number], s.gaps.length[number] = start, length
        if length <= 4:
            visit = start
            for _ in range(length):
                if s.visits.status[visit] == ROLLED or s.visits.status[visit] == EAR:
                    _unlink_rolled(s, visit)
                    s.visits.status[visit] = UNKNOWN
                visit = s.visits.after[visit]
        s.stack[s.counts[STACK]] = number
        s.counts[STACK] += 1


# --- dividing gaps


@_compiled
def _sort(keys, items, start, end):
    """Sort items by their keys, the lower item first among equal keys.

    This is Shell's method, because numba takes seconds to compile numpy's.
    """
    step = 1
    while 3 * step < end - start:
        step = 3 * step + 1
    while step > 0:
        for at in range(start + step, end):
            key, item, place = keys[at], items[at], at
            while place - step >= start:
                other = keys[place - step]
                if other < key or (other == key and items[place - step] < item):
                    break
                keys[place], items[place] = other, items[place - step]
                place -= step
            keys[place], items[place] = key, item
        step //= 3


@_compiled
def _sort_group(s, size):
    """Sort leaves by their disks' numbers."""
    if size > 1:
        keys = np.empty(size, dtype=np.float64)
        for at in range(size):
            visit = s.group[at]
            keys[at] = _leaf(s.visits.disk[visit], s.visits.disk[s.visits.after[visit]])
        _sort(keys, s.group, 0, size)


@_compiled
def _leaf(i, j):
    """Return a number that sorts leaves as pairs are sorted; it is exact up to 2 ** 26 disks."""
    return i * 67108864.0 + j


@_compiled
def _lacks_room(s, gap):
    count = s.counts[CONTACTS]
    most = 2 * (s.gaps.length[gap] + 4 * count)
    return (
        count > len(s.contacts)
        or s.counts[DISKS] + 1 >= len(s.disks)
        or s.counts[VISITS] + 2 * count >= len(s.visits)
        or s.counts[GAPS] + count >= len(s.gaps)
        or s.counts[STACK] + count >= len(s.stack)
        or s.counts[NODES] + 4 * DEEPEST >= len(s.first)
        or len(s.entries) - s.counts[ENTRIES] + s.counts[FREED] < most
    )


@_compiled
def _divide(s, gap):
    """Place the largest disk that helps."""
    second, aside = -1, 0
    while True:
        first = _pop(s, gap, -np.inf)
        if first < 0:
            break
        s.group[0] = first
        size = 1
        least = s.visits.rolled_r[first] * (1 - s.limits[EQUAL])
        while True:
            other = _pop(s, gap, least)
            if other < 0:
                break
            s.group[size] = other
            size += 1
        _sort_group(s, size)
        for at in range(size):
            visit = s.group[at]
            verdict = _try(s, gap, s.visits.rolled_x[visit], s.visits.rolled_y[visit], s.visits.rolled_r[visit])
            lacks_room = (verdict != FAILS or s.counts[CONTACTS] > len(s.contacts)) and _lacks_room(s, gap)
            if verdict == HELPS or lacks_room:
                for back in range(at if lacks_room else at + 1, size):
                    _push(s, s.group[back])
                for back in range(aside):
                    _push(s, s.aside[back])
                if lacks_room:
                    return GROW
                _place(s, gap, s.visits.rolled_x[visit], s.visits.rolled_y[visit], s.visits.rolled_r[visit])
                return GO_ON
            if verdict == FAILS:
                s.visits.status[visit] = EAR
            else:
                if second < 0:
                    second = visit
                s.aside[aside] = visit
                aside += 1
    for back in range(aside):
        _push(s, s.aside[back])
    if second >= 0:
        _try(s, gap, s.visits.rolled_x[second], s.visits.rolled_y[second], s.visits.rolled_r[second])
        _place(s, gap, s.visits.rolled_x[second], s.visits.rolled_y[second], s.visits.rolled_r[second])
        return GO_ON
    return _divide_inside(s, gap)


@_compiled
def _divide_inside(s, gap):
    """Place the largest disk that helps among those met beyond the ears."""
    length = s.gaps.length[gap]
    chain = np.empty(length, dtype=np.int32)
    visit = s.gaps.head[gap]
    for at in range(length):
        chain[at] = visit
        visit = s.visits.after[visit]
    disks, keys = np.empty(length, dtype=np.int32), np.empty(2 * length)
    for at in range(length):
        disks[at] = s.visits.disk[chain[at]]
        keys[at] = disks[at]
    _sort(keys, disks, 0, length)
    found = np.empty((2 * length, 3))
    leaves = np.empty(2 * length)
    order, place = np.empty(2 * length, dtype=np.int32), np.empty(2 * length, dtype=np.int32)
    count = 0
    for at in range(length):
        visit = chain[at]
        i, j, k = s.visits.disk[visit], s.visits.disk[chain[(at + 1) % length]], s.visits.disk[chain[(at + 2) % length]]
        if s.visits.status[visit] != EAR and s.visits.status[visit] != ROLLED:
            continue
        x, y, r = s.visits.rolled_x[visit], s.visits.rolled_y[visit], s.visits.rolled_r[visit]
        off_x, off_y = x - s.disks.x[k], y - s.disks.y[k]
        if i == k or abs(math.sqrt(off_x * off_x + off_y * off_y) - r - s.disks.r[k]) > 1e-6 * min(r, s.disks.r[k]):
            continue
        count = _beyond(s, i, j, k, x, y, r, disks, found, leaves, _leaf(i, j), count)
    for at in range(count):
        order[at], keys[at] = at, -found[at, R]
    _sort(keys, order, 0, count)
    start = 0
    while start < count:
        least = found[order[start], R] * (1 - s.limits[EQUAL])
        end = start
        while end < count and found[order[end], R] >= least:
            end += 1
        for at in range(start, end):
            place[at], keys[at] = at, leaves[order[at]]
        _sort(keys, place, start, end)
        for at in order[place[start:end]]:
            verdict = _try(s, gap, found[at, X], found[at, Y], found[at, R])
            if (verdict != FAILS or s.counts[CONTACTS] > len(s.contacts)) and _lacks_room(s, gap):
                return GROW
            if verdict != FAILS:
                _place(s, gap, found[at, X], found[at, Y], found[at, R])
                return GO_ON
        start = end
    return STUCK


@_compiled
def _beyond(s, i, j, k, ear_x, ear_y, ear_r, disks, found, leaves, leaf, count):
    """Add the first two disks beyond an ear that touch i and k; see ``GrowingDisks.beyond``."""
    x, y = s.disks.x[k] - s.disks.x[i], s.disks.y[k] - s.disks.y[i]
    a_x, a_y, r_a = s.disks.x[i], s.disks.y[i], s.disks.r[i]
    to_j_x, to_j_y, r_j = x, y, s.disks.r[k] - r_a
    b_j = (to_j_x * to_j_x + to_j_y * to_j_y - r_j * r_j) / 2
    enough = 1e-6 * ear_r * math.sqrt(x * x + y * y)
    best = (np.inf, 0.0, 0.0, 0.0)  # how far ahead, x, y, radius
    next_best = best
    for sign in (1.0, -1.0):
        last = -1
        for other in disks:
            if other == last or other in (i, j, k):
                continue
            last = other
            to_k_x, to_k_y, r_k = s.disks.x[other] - a_x, s.disks.y[other] - a_y, s.disks.r[other] - r_a
            determinant = to_j_x * to_k_y - to_j_y * to_k_x
            b_k = (to_k_x * to_k_x + to_k_y * to_k_y - r_k * r_k) / 2
            p_x, p_y = (b_j * to_k_y - b_k * to_j_y) / determinant, (b_k * to_j_x - b_j * to_k_x) / determinant
            q_x, q_y = (r_k * to_j_y - r_j * to_k_y) / determinant, (r_j * to_k_x - r_k * to_j_x) / determinant
            square, half_linear = q_x * q_x + q_y * q_y - 1, p_x * q_x + p_y * q_y
            constant = p_x * p_x + p_y * p_y
            root = np.sqrt(half_linear * half_linear - square * constant)
            reach = (-half_linear + sign * root) / square
            centre_x, centre_y, radius = a_x + p_x + q_x * reach, a_y + p_y + q_y * reach, reach - r_a
            ahead = (centre_y - ear_y) * x - (centre_x - ear_x) * y
            if not (np.isfinite(radius) and radius > 0 and ahead > enough):
                continue
            if ahead < best[0]:
                best, next_best = (ahead, centre_x, centre_y, radius), best
            elif ahead < next_best[0]:
                next_best = (ahead, centre_x, centre_y, radius)
    for ahead, centre_x, centre_y, radius in (best, next_best):
        if ahead < np.inf:
            found[count, X], found[count, Y], found[count, R] = centre_x, centre_y, radius
            leaves[count] = leaf
            count += 1
    return count


@_called
def _run(s, most):
    """Divide gaps until none is left, ``most`` steps are done, or the arrays are full."""
    s = uncounted(s)
    for _ in range(most):
        if s.counts[STACK] == 0:
            return DONE
        gap = s.stack[s.counts[STACK] - 1]
        length = s.gaps.length[gap]
        if length <= 4:
            if length < 3:
                return STUCK
            if s.counts[OUT] + 2 >= len(s.out_offsets) or s.counts[OUT_VALUES] + 4 >= len(s.out_values):
                return GROW
            _free_heap(s, gap)
            s.counts[STACK] -= 1
            visit = s.gaps.head[gap]
            for _ in range(length):
                s.out_values[s.counts[OUT_VALUES]] = s.visits.disk[visit]
                s.counts[OUT_VALUES] += 1
                visit = s.visits.after[visit]
            s.counts[OUT] += 1
            s.out_offsets[s.counts[OUT]] = s.counts[OUT_VALUES]
        else:
            said = _divide(s, gap)
            if said != GO_ON:
                return said
    return GO_ON


@_called
def _insert_disks(s, disks):
    s = uncounted(s)
    for disk in disks:
        s.disks.first_visit[disk] = -1
        _insert_disk(s, disk)


@_called
def _add_chain(s, chain):
    """Make a chain one gap, and roll the disks of all its leaves."""
    s = uncounted(s)
    gap = s.counts[GAPS]
    s.counts[GAPS] += 1
    s.gaps.heap[gap], s.gaps.length[gap], s.gaps.head[gap] = -1, len(chain), s.counts[VISITS]
    start = s.counts[VISITS]
    for disk in chain:
        _new_visit(s, disk, gap)
    end = s.counts[VISITS]
    for visit in range(start, end):
        s.visits.after[visit] = visit + 1 if visit + 1 < end else start
        s.visits.before[visit] = visit - 1 if visit > start else end - 1
    s.stack[s.counts[STACK]] = gap
    s.counts[STACK] += 1
    if len(chain) > 4:
        for visit in range(start, end):
            _roll_leaf(s, visit, -1)


@_called
def _roll_many(s, leaves, centres, radii):
    s = uncounted(s)
    for at in range(len(leaves)):
        if _roll(s, leaves[at, 0], leaves[at, 1], -1):
            centres[at, 0], centres[at, 1], radii[at] = s.found[X], s.found[Y], s.found[R]
        else:
            radii[at] = -1.0


class GapFiller:
    """Fills gaps of one chain, face after face; disks keep their numbers."""

    def __init__(self, tie: float, rounding: float, nearly: float, equal: float) -> None:
        self._limits = (tie, rounding, nearly, equal)
        self._state = _empty(0, 0, np.zeros(EQUAL + 1))
        self._known = 0

    def start(self, disks: Indices, centres: Floats, radii: Floats, count: int) -> bool:
        """Begin a face whose boundary ``disks`` are among the first ``count`` of ``centres`` and ``radii``.

        Returns whether the code still has to be compiled, which takes about 20 s once on a machine.
        """
        mine = centres[disks]
        low, high = mine.min(axis=0), mine.max(axis=0)
        middle = (low + high) / 2
        half = float((high - low).max() + radii[disks].max())
        state = _empty(count + 2 * len(disks), len(disks), np.array([*middle, half, *self._limits]))
        self._write(state, slice(0, count), centres, radii)
        state.counts[:] = 0
        state.counts[FREE] = -1
        state.counts[NODES] = 2
        state.child[:2], state.first[:2] = -1, -1
        state.counts[DISKS] = self._known = count
        _insert_disks(state, disks.astype(np.int32))
        self._state = state
        return bool(_insert_disks.stats.cache_misses) and not _run.signatures

    def add(self, centres: Floats, radii: Floats, count: int) -> None:
        """Take over the disks that others added since the last call."""
        if count > self._known:
            self._reserve(disks=count)
            state, new = self._state, slice(self._known, count)
            self._write(state, new, centres, radii)
            state.counts[DISKS] = count
            _insert_disks(state, np.arange(self._known, count, dtype=np.int32))
            self._known = count

    def roll(self, leaves: Indices) -> tuple[Floats, Floats]:
        """Return centre and radius of the disk of each leaf, ``(n, 2)``; the radius is negative where there is none."""
        centres, radii = np.empty((len(leaves), 2)), np.empty(len(leaves))
        _roll_many(self._state, leaves, centres, radii)
        return centres, radii

    def fill(self, chain: Indices, report: Callable[[], None]) -> Filled:
        """Divide the gap inside one chain until no gap has more than 4 sides.

        ``report`` is called every so many divisions. Raises ``StuckError``.
        """
        size = len(chain)
        counters = self._state.counts
        self._reserve(visits=counters[VISITS] + 2 * size + 64, entries=counters[ENTRIES] + 2 * size + 64)
        state = self._state
        state.counts[OUT] = state.counts[OUT_VALUES] = 0
        _add_chain(state, chain.astype(np.int32))
        said = GO_ON
        while said != DONE:
            said = _run(self._state, AT_ONCE)
            if said == STUCK:
                raise self._stuck()
            if said == GROW:
                self._grow()
            report()
        state, new = self._state, slice(self._known, int(self._state.counts[DISKS]))
        self._known = int(state.counts[DISKS])
        gaps, values = int(state.counts[OUT]), int(state.counts[OUT_VALUES])
        disks = state.disks[new]
        centres, radii = np.stack([disks["x"], disks["y"]], axis=1), disks["r"].copy()
        return Filled(centres, radii, state.out_values[:values].copy(), state.out_offsets[: gaps + 1].copy())

    def _stuck(self) -> StuckError:
        state = self._state
        gap = state.stack[state.counts[STACK] - 1]
        chain, visit = [], state.gaps["head"][gap]
        for _ in range(state.gaps["length"][gap]):
            chain.append(int(state.visits["disk"][visit]))
            visit = state.visits["after"][visit]
        disks = state.disks[chain]
        return StuckError([chain], (float(disks["x"].mean()), float(disks["y"].mean())))

    @staticmethod
    def _write(state: _State, disks: slice, centres: Floats, radii: Floats) -> None:
        state.disks["x"][disks], state.disks["y"][disks] = centres[disks].T
        state.disks["r"][disks] = radii[disks]

    def _grow(self) -> None:
        """Double the arrays that are more than about a quarter full."""
        state = self._state
        count = state.counts
        sizes = [len(getattr(state, names[0])) for names in GROUPS]
        used = [
            count[DISKS],
            count[VISITS],
            count[NODES],
            count[ENTRIES] - count[FREED],
            count[GAPS],
            count[STACK],
            count[OUT],
            count[OUT_VALUES],
            count[CONTACTS],
        ]
        sizes = [2 * size if 4 * use + 1024 > size else size for size, use in zip(sizes, used, strict=True)]
        self._state = _resized(state, sizes)

    def _reserve(self, disks: int = 0, visits: int = 0, entries: int = 0) -> None:
        sizes = [len(getattr(self._state, names[0])) for names in GROUPS]
        wanted = [disks + 1, visits, 0, entries, 0, 0, 0, 0, 0]
        if any(size < want for size, want in zip(sizes, wanted, strict=True)):
            sizes = [max(size, want + want // 4) for size, want in zip(sizes, wanted, strict=True)]
            self._state = _resized(self._state, sizes)


def _empty(disks: int, boundary: int, limits: Floats) -> _State:
    sizes = (disks, 8 * boundary, 8 * boundary, 4 * boundary, 4 * boundary, 64, 2 * boundary, 7 * boundary, 64)
    arrays = {
        name: np.zeros((size + 256, 4) if name in ("child", "bounds") else size + 256, TYPES.get(name, np.int32))
        for names, size in zip(GROUPS, sizes, strict=True)
        for name in names
    }
    return _State(
        **arrays,
        counts=np.zeros(BLOCKED + 1, dtype=np.int64),
        limits=limits,
        found=np.zeros(R + 1),
        path=np.zeros(4 * DEEPEST + 8, dtype=np.int32),
    )


def _resized(state: _State, sizes: list[int]) -> _State:
    """Return the state with longer arrays."""
    changed = {}
    for names, size in zip(GROUPS, sizes, strict=True):
        for name in names:
            old = getattr(state, name)
            if len(old) < size:
                changed[name] = np.zeros((size, *old.shape[1:]), dtype=old.dtype)
                changed[name][: len(old)] = old
    return state._replace(**changed)
