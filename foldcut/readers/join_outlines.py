"""From drawn outlines to loops of one even-odd set: gaps, chains of lines and stray lines.

``Outline``s as the readers find them -> ``Loops`` (``loops_of``); ``closed_loops`` is for formats that have loops
already. ``readers.fill_outlines`` says what they fill. Places are told in the coordinates of the file.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, repeat

import numpy as np

from foldcut.core.arrays import Floats, Ints, index_array, points_array
from foldcut.core.errors import FileFormatError
from foldcut.core.units import rounded_up
from foldcut.geometry.curves import CurvedLoop, Line, Segment
from foldcut.readers.base import Drawing, ReadOptions, counted
from foldcut.readers.cut_curves import CutCurves
from foldcut.readers.fill_outlines import Paint, Part, Place, fill, named, unite

MOST_MEETING = 50
"""If more ends of lines than this meet on average, they are not an outline, and joining them would take long."""

ROUNDING = 2e-6
"""Gaps that are smaller than this, relative to the size of the drawing, are rounding and are not reported."""

FLAT = 1e-12
"""A loop that is thinner than this, relative to its length, is a line and has no area."""

LARGEST = 1e100
"""Lines that end farther away than this are refused."""


FILLED_OVER = "left out loops that the fill rule nonzero fills over, since they run the same way round: {}"
"""The note on such loops."""


CUT_OPEN = "cut along open lines, too, with --open"
"""The remedy where lines are no outline."""


@dataclass(frozen=True, eq=False)
class Outline:
    """What one element of a file draws: lines, ``(n, 2)``, and whether each is closed.

    Closed lines may repeat their first point. ``filled``: open lines are closed, too; if they are not filled, they are
    joined with those of other elements. ``even_odd``: the fill rule; else it is nonzero. ``curves``: the segments that
    each line was flattened from, from its first point to its last, or none if they are straight; it may be left out.
    ``name``: what it is called in reports. ``paint``: of its area.
    """

    lines: Sequence[tuple[Floats, bool]]
    filled: bool = False
    even_odd: bool = True
    curves: Sequence[Sequence[Segment]] = ()
    name: str = "an outline"
    paint: Paint = Paint.DARK


@dataclass(frozen=True, eq=False)
class Loops:
    """Closed loops of one even-odd set, ``notes`` on how they were found, and ``repairs`` that were needed.

    ``curves``: the loops before they were flattened; nothing if all are polygons. ``lost``: loops that others cover.
    ``lines``: if all lines are to be cut as drawn, these, and no loops; ends are joined later that are no farther apart
    than ``join``.
    """

    loops: tuple[Floats, ...]
    notes: tuple[str, ...]
    repairs: tuple[str, ...]
    curves: tuple[CurvedLoop, ...] = ()
    lost: tuple[Floats, ...] = ()
    lines: tuple[Floats, ...] = ()
    join: float | None = None

    def drawing(
        self,
        unit_mm: float | None,
        title: str,
        notes: tuple[str, ...],
        ignored: tuple[str, ...],
        *,
        y_down: bool = False,
    ) -> Drawing:
        """Return the drawing that they make; ``notes`` are all of it, and the others as in ``Drawing``."""
        return Drawing(
            self.loops,
            unit_mm,
            title,
            notes,
            y_down,
            ignored,
            self.repairs,
            self.curves,
            self.lost,
            lines=self.lines,
            join=self.join,
        )


def loops_of(
    outlines: Sequence[Outline], options: ReadOptions, unit_mm: float | None, extent: float, *, own_y: float = 1.0
) -> Loops:
    """Return the loops that outlines enclose; ``extent`` is the longer side of the drawing.

    ``own_y``: what y is multiplied by to be that of the file, in which places are told. Ends that are no more than
    ``options.join_gap`` apart are joined. What encloses no area is left out. Raises ``FileFormatError`` if nothing is
    left then.

    With ``options.open_lines`` nothing is joined, filled or left out.
    """
    if options.open_lines:
        return _as_drawn(outlines, options, unit_mm, extent)
    gap = options.join_gap(unit_mm, extent)

    def place(point: Floats) -> str:
        return f"({point[0] + 0.0:g}, {point[1] * own_y + 0.0:g})"

    parts: list[Part] = []
    over: list[Part] = []
    chains: list[Floats] = []
    chain_curves: list[Sequence[Segment]] = []
    gaps: list[float] = []
    # by the id of the loop, which is kept alive: what is neither cut nor joined stays the same array
    curved: dict[int, tuple[Floats, CurvedLoop]] = {}
    flat = 0
    for outline in outlines:
        closed: list[Floats] = []
        for (points, is_closed), curve in zip(outline.lines, outline.curves or repeat(()), strict=False):
            end = _end_gap(points)
            if end <= gap and (is_closed or len(points) > 2):
                gaps.append(end)
                closed.append(points[:-1])
            elif is_closed or (outline.filled and len(points) > 2):
                closed.append(points)
            elif end <= gap:
                flat += 1
                continue
            else:
                chains.append(points)
                chain_curves.append(curve)
                continue
            if curve:
                curved[id(closed[-1])] = closed[-1], _closed_curve(curve, extent)
        whole = [loop for loop in closed if not _is_flat(loop)]
        flat += len(closed) - len(whole)
        filled = fill(whole, even_odd=outline.even_odd)
        kept = {id(loop) for loop in filled}
        if kept <= {id(loop) for loop in whole}:  # it was not divided
            over += [Part([loop], outline.name) for loop in whole if id(loop) not in kept]
        parts.append(Part(filled, outline.name, outline.paint))
        flat += 0 if parts[-1].loops else len(whole)
    united = unite(parts, place)
    loops = united.loops
    joined, more, stray, trails = join(chains, gap, place, unit_mm or 1.0, alone=not loops)
    for loop, trail in zip(joined, trails, strict=True):
        if any(chain_curves[number] for number, _ in trail):
            curved[id(loop)] = loop, _closed_curve(_joined_curves(chains, chain_curves, trail), extent)
    whole = [loop for loop in joined if not _is_flat(loop)]
    flat += len(joined) - len(whole)
    if not loops and not whole:
        raise FileFormatError(
            f"the outlines of the file enclose no area; draw at least one closed outline, or {CUT_OPEN}"
        )
    nothing = f"left out {flat} outline{'s' * (flat > 1)} without area" if flat else ""
    repairs = filter(None, [_closed_gaps([*gaps, *more], extent, unit_mm), stray, nothing])
    found = (*loops, *whole)
    curves, lost = _curves_of(found, curved), (*united.lost, *(loop for part in over for loop in part.loops))
    notes = [FILLED_OVER.format(named(over, place))] if over else []
    return Loops(found, (*united.notes, *notes), tuple(repairs), curves, lost)


def _as_drawn(outlines: Sequence[Outline], options: ReadOptions, unit_mm: float | None, extent: float) -> Loops:
    """Return all outlines as lines, as they are drawn; closed ones end where they begin."""
    lines = [
        points_array(np.concatenate([points, points[:1]]))
        if is_closed or (outline.filled and len(points) > 2)
        else points
        for outline in outlines
        for points, is_closed in outline.lines
        if len(points)
    ]
    join = None if options.join_mm is None else options.join_gap(unit_mm, extent)
    return Loops((), (), (), lines=tuple(lines), join=join)


def closed_loops(
    drawn: Sequence[Floats], options: ReadOptions, unit_mm: float | None
) -> tuple[tuple[Floats, ...], tuple[str, ...]]:
    """Return drawn loops without a last point that nearly repeats the first one, and the repairs that were needed."""
    points = np.concatenate([loop[np.isfinite(loop).all(axis=1)] for loop in drawn])
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    gap = options.join_gap(unit_mm, extent)
    ends = [_end_gap(loop) if len(loop) > 3 else 0.0 for loop in drawn]
    repair = _closed_gaps([end for end in ends if end <= gap], extent, unit_mm)
    closed = (loop[:-1] if 0 < end <= gap else loop for loop, end in zip(drawn, ends, strict=True))
    return tuple(map(points_array, closed)), (repair,) if repair else ()


def drawing_of(
    rings: Sequence[Floats], lines: Sequence[Floats], title: str, options: ReadOptions, ignored: Counter[str]
) -> Drawing:
    """Return a drawing, its unit unknown: the rings of polygons or, if there are none, the loops that lines form."""
    if rings and not (options.open_lines and lines):
        closed, repairs = closed_loops(rings, options, None)
        return Drawing(closed, None, title, ignored=counted(ignored + Counter(line=len(lines))), repairs=repairs)
    points = np.concatenate([*rings, *lines])
    finite = points[np.isfinite(points).all(axis=1)]
    extent = float(np.ptp(finite, axis=0).max()) if len(finite) else 0.0
    outlines = [Outline([(ring, True) for ring in rings]), Outline([(line, False) for line in lines])]
    found = loops_of(outlines if rings else outlines[1:], options, None, extent)
    return Drawing(
        found.loops,
        None,
        title,
        found.notes,
        ignored=counted(ignored),
        repairs=found.repairs,
        lines=found.lines,
        join=found.join,
    )


def _curves_of(loops: Sequence[Floats], curved: dict[int, tuple[Floats, CurvedLoop]]) -> tuple[CurvedLoop, ...]:
    """Return the curve of each loop; nothing if all are polygons. ``curved``: by id, loops and what they were."""
    if not curved:
        return ()
    found = [curved[id(loop)][1] if id(loop) in curved else None for loop in loops]
    if not all(found):
        known = CutCurves(*zip(*curved.values(), strict=True))
        found = [curve or known.curve_of(loop) for curve, loop in zip(found, loops, strict=True)]
    if not any(found):
        return ()
    return tuple(curve or CurvedLoop.of_points(loop) for curve, loop in zip(found, loops, strict=True))


def _closed_curve(segments: Sequence[Segment], extent: float) -> CurvedLoop:
    """Return the loop that segments make, with lines over the gaps between them and from the end to the start."""
    loop: list[Segment] = []
    for segment, following in zip(segments, [*segments[1:], segments[0]], strict=True):
        loop.append(segment)
        if float(np.hypot(*(following.start - segment.end))) > FLAT * extent:
            loop.append(Line(segment.end, following.start))
    return CurvedLoop(tuple(loop))


def _joined_curves(
    chains: Sequence[Floats], curves: Sequence[Sequence[Segment]], trail: Sequence[tuple[int, bool]]
) -> list[Segment]:
    """Return the segments of chains in the order and the direction in which they were joined."""
    segments: list[Segment] = []
    for number, backwards in trail:
        own = curves[number] or [Line(one, other) for one, other in pairwise(chains[number])]
        segments += [segment.reversed() for segment in own[::-1]] if backwards else own
    return segments


def _end_gap(points: Floats) -> float:
    """Return the distance between the ends of a line."""
    with np.errstate(all="ignore"):
        return float(np.hypot(*(points[-1] - points[0])))


def _is_flat(loop: Floats) -> bool:
    """Whether a loop has no area: a point, or a line drawn there and back."""
    if not np.isfinite(loop).all():
        return False  # make_shape says where
    if len(loop) < 3:
        return True
    along = loop - loop[0]
    far = along[np.abs(along).sum(axis=1).argmax()]
    with np.errstate(all="ignore"):
        return bool((np.abs(along[:, 0] * far[1] - along[:, 1] * far[0]) <= FLAT * (far**2).sum()).all())


def _closed_gaps(gaps: Sequence[float], extent: float, unit_mm: float | None) -> str:
    """Return a sentence on the gaps that were closed, in mm or, if the unit is unknown, in drawing units."""
    gaps = [gap for gap in gaps if gap > ROUNDING * extent]
    if not gaps:
        return ""
    most = f"{max(gaps):.2g}" if unit_mm is None else f"{max(gaps) * unit_mm:.2g} mm"
    return f"closed {len(gaps)} gap{'s' * (len(gaps) > 1)} of at most {most} between ends of lines"


def join(
    chains: Sequence[Floats], gap: float, place: Place, mm: float, *, alone: bool
) -> tuple[list[Floats], list[float], str, list[list[tuple[int, bool]]]]:
    """Return the loops that open lines form if ends no more than ``gap`` apart are joined.

    With them come the lengths of all gaps, a sentence on what was left out (lines that repeat others, and lines with an
    end where no other line continues), and for each loop its lines in order: their numbers, and whether they run
    backwards. Raises ``FileFormatError`` with the place where three lines meet, and, if
    there is no loop at all, with that of an end where no line continues; ``alone`` means that these lines are all there
    is. ``place`` tells places; ``mm``: how many mm ``--join`` counts for a unit of the drawing.
    """
    if not chains:
        return [], [], "", []
    ends = np.array([(chain[0], chain[-1]) for chain in chains]).reshape(-1, 2)
    if not (np.abs(ends) < LARGEST).all():  # distances overflow
        raise FileFormatError(f"a line ends at a place that is not finite; give numbers below {LARGEST:g}")
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    tree = KDTree(ends)
    if tree.count_neighbors(tree, gap) > MOST_MEETING * len(ends):
        raise FileFormatError("too many lines end at the same places; draw an outline, or give a smaller --join")
    pairs = tree.query_pairs(gap, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    _, node = connected_components(links, directed=False)
    left, free, repeated = _without_strays(chains, index_array(node.reshape(-1, 2)))
    meeting: dict[int, list[int]] = {}
    for number in sorted(left):
        for end in (2 * number, 2 * number + 1):
            meeting.setdefault(int(node[end]), []).append(end)
    stray = f"left out {repeated} line{'s' * (repeated > 1)} drawn twice" if repeated else ""
    if free:
        distances = np.max(tree.query(ends[free], k=2)[0], axis=1)
        distances = np.where(np.isfinite(distances), distances, 0.0)
        at = f"at {place(ends[free[0]])}, {distances[0]:.3g} from the next end"
        if alone and not left:
            enough = rounded_up(1.001 * float(distances.max()) * mm)
            raise FileFormatError(
                f"a line ends {at}; close the outline, or join ends that are farther apart with --join {enough}mm, "
                f"or {CUT_OPEN}"
            )
        what = f"{len(free)} lines that end" if len(free) > 1 else "a line that ends"
        stray = "; ".join(filter(None, [stray, f"left out {what} where no other continues, {at} ({CUT_OPEN})"]))
    for members in meeting.values():
        if len(members) > 2:
            at = place(ends[members[0]])
            raise FileFormatError(
                f"{len(members)} lines end at {at}; keep only two, so that one continues the other, or {CUT_OPEN}"
            )
    loops, gaps, trails = [], [], []
    for start in sorted(left):
        end, points, trail = 2 * start, list[Floats](), list[tuple[int, bool]]()
        while end // 2 in left:
            left.discard(end // 2)
            trail.append((end // 2, end % 2 == 1))
            chain = chains[end // 2] if end % 2 == 0 else chains[end // 2][::-1]
            points.append(chain[:-1])
            far = end ^ 1
            first, second = meeting[int(node[far])]
            end = second if first == far else first
            gaps.append(float(np.hypot(*(ends[end] - ends[far]))))
        if points:
            loops.append(points_array(np.concatenate(points)))
            trails.append(trail)
    return loops, gaps, stray, trails


def _without_strays(chains: Sequence[Floats], nodes: Ints) -> tuple[set[int], list[int], int]:
    """Return the lines that continue at both ends, the loose ends of those that do not, and the number of repetitions.

    ``nodes`` ``(n, 2)``: the place of each end of each line, as a number. Taking a line away may make its neighbour's
    end a loose one.
    """
    left: set[int] = set()
    seen: set[tuple[bytes, ...]] = set()
    for number, chain in enumerate(chains):
        drawn = tuple(sorted((chain.tobytes(), chain[::-1].tobytes())))
        if drawn not in seen:
            left.add(number)
        seen.add(drawn)
    repeated = len(chains) - len(left)
    at: dict[int, set[int]] = {}
    for number in sorted(left):
        for end in (0, 1):
            at.setdefault(int(nodes[number, end]), set()).add(2 * number + end)
    free: list[int] = []
    waiting = [next(iter(members)) for members in at.values() if len(members) == 1]
    for end in waiting:  # the list grows in the loop
        if end // 2 not in left:
            continue
        left.discard(end // 2)
        free.append(end)
        for one in (end, end ^ 1):
            members = at[int(nodes[one // 2, one % 2])]
            members.discard(one)
            if len(members) == 1:
                waiting += members
    return left, free, repeated
