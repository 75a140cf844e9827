"""Decide whether a FOLD file's pattern folds flat: it does, it does not, or that is not decided.

``FoldFile`` -> ``Decision``. A file that is right as it stands is judged as it stands (``judge``). Beyond that,

- coordinates may be rounded: the vertices may move as far as the tolerance says, to the nearest pattern whose angles
  fold flat exactly; a file that says that they were moved is given as much slack as the one before it, and no more;
- a layer order that is missing, or is given for some pairs of faces only, is looked for;
- edges assigned U may be folded either way, and if they cannot be folded, stay flat.

Each order that is found is proven by ``verify``, which knows nothing of how it was found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Indices, Ints
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.foldfile.judge import FIELDS, judge, judge_fields
from foldcut.foldfile.read import FoldFile
from foldcut.geometry.planar_graph import edge_faces
from foldcut.layer_orders.count import States
from foldcut.layer_orders.folded_sheet import CLEAR, tolerances_of
from foldcut.layer_orders.orders import Found, count_orders, find_order, with_folds
from foldcut.pattern.face_maps import fold_faces, folded_edges
from foldcut.pattern.repair import Repaired, nearest_foldable
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import PairOrder, verify

__all__ = ["TOLERANCE", "Decision", "decide", "states_of"]

TOLERANCE = 3e-5
"""How far vertices may be moved, relative to the sheet's diagonal, unless the user says it.

Coordinates that are rounded to 1e-5 of the sheet are up to 0.7e-5 off, and exact angles need up to four times as much.
"""

ANGLES = {"kawasaki", "closure"}
"""The checks that rounded coordinates fail."""

ORDER = {"layers", "mountain-valley", "taco-tortilla", "tortilla-tortilla", "taco-taco"}
"""The checks of the layer order."""

EXACT = 1e-12
"""Vertices that would be moved by no more than this, relative to the sheet's diagonal, are not moved."""

ERRORS = (100.0, 30.0, 10.0)
"""How many times as far as a vertex was moved points may be apart that should coincide when the sheet is folded."""

FORM = 3.0
"""How many tolerances the vertices of a folded form may be from where the creases put them."""

LOOSEST = 3e-4
"""Overlaps that are deeper than this, relative to the sheet's diagonal, always count."""

NO_PAIRS: Ints = np.empty((0, 2), dtype=np.int32)
NO_ORDERS: Ints = np.empty((0, 3), dtype=np.int32)


@dataclass(frozen=True, eq=False)
class Decision:
    """``folds``: True, False, or None where it is not decided; ``sentence`` says it, ``findings`` why not.

    ``pattern`` is what was judged: with vertices moved, where ``moved`` says so, and a mountain or valley for each U.
    ``pairs`` ``(n, 2)``: the order that was found, the upper face first; None if the file's own was judged.
    ``tolerance``, relative to the sheet's diagonal, is what it was found with.
    """

    folds: bool | None
    sentence: str
    pattern: CreasePattern
    findings: tuple[Finding, ...] = ()
    pairs: Indices | None = None
    moved: Repaired | None = None
    notes: tuple[str, ...] = ()
    tolerance: float | None = None

    def __repr__(self) -> str:
        return f"<Decision: {self.sentence}>"


def decide(file: FoldFile, shape: Shape | None = None, tolerance: float = TOLERANCE) -> Decision:
    """Decide whether the pattern of a file folds flat and, with a ``shape``, whether the cut gives that shape."""
    cuts = np.flatnonzero(file.pattern.edges_assignment == "C")
    if len(cuts):
        x, y = file.pattern.vertices_coords[file.pattern.edges_vertices[cuts[0]]].mean(axis=0).tolist()
        what = f"edge {cuts[0]} at ({x:.4g}, {y:.4g}) cuts into the sheet (C)"
        return _undecided(file.pattern, f"{what}, and foldcut judges sheets without cuts; leave it out to try without")
    findings = judge(file, shape)
    if not findings:
        return Decision(True, "folds flat as the file says", file.pattern)
    near_mm = FORM * tolerance * _diagonal(file.pattern)
    if {finding.check for finding in findings} == {FIELDS} and not judge_fields(file, near_mm):
        off = max(finding.size for finding in findings)
        note = f"the folded form in the file is up to {off:.3g} mm from where the creases put it"
        return Decision(True, "folds flat as the file says", file.pattern, notes=(note,))
    deciding = _Deciding(file, shape, tolerance, findings)
    decision = deciding.decide(file.pattern)
    letters, wrong = file.pattern.edges_assignment, {finding.check for finding in decision.findings}
    if not wrong & (ANGLES | {"maekawa"}) or not (letters == "U").any() or not folded_edges(file.pattern).any():
        return decision
    flat = deciding.decide(with_folds(file.pattern, "F"))  # unassigned edges that cannot be folded may stay flat
    return flat if flat.folds else decision


def states_of(file: FoldFile, decision: Decision) -> States | None:
    """Return how many layer orders a pattern has of which it was decided that it folds; None: too many to be counted.

    Edges that the file leaves unassigned count both ways.
    """
    free = (file.pattern.edges_assignment == "U") & folded_edges(decision.pattern)
    letters = np.where(free, "U", decision.pattern.edges_assignment)
    pattern = replace(decision.pattern, edges_assignment=letters)
    tolerance = decision.tolerance
    if tolerance is None:
        error = 0.0 if decision.moved is None else decision.moved.most
        tolerance = find_order(pattern, NO_PAIRS, error).tolerance
    return count_orders(pattern, tolerance)


class _Deciding:
    """Decides about one file with ``before``, what is wrong with it as it stands."""

    def __init__(self, file: FoldFile, shape: Shape | None, tolerance: float, before: list[Finding]) -> None:
        self.file, self.shape, self.tolerance, self.before = file, shape, tolerance, before

    def decide(self, pattern: CreasePattern) -> Decision:
        """Decide about a pattern: the file's own, or the same with other letters for U."""
        folding = with_folds(pattern)
        found = self.before
        if (folding.edges_assignment != self.file.pattern.edges_assignment).any():
            found = [finding for finding in verify(folding, None, self.shape) if not self._is_open(pattern, finding)]
        checks = {finding.check for finding in found}
        if checks & {"arrays", "planar"}:
            return _refused(pattern, f"is not divided into faces as a sheet has to be: {found[0]}", found)
        if not checks <= ANGLES | ORDER | {"cut"}:
            return _refused(pattern, f"does not fold flat: {found[0]}", found)
        moved = nearest_foldable(folding, edge_faces(folding))
        diagonal = _diagonal(pattern)
        if moved is None or moved.most > self.tolerance * diagonal:
            if checks & ANGLES:
                return _refused(pattern, f"does not fold flat: {self._too_far(found, moved, diagonal)}", found)
            moved = None
        elif moved.most <= EXACT * diagonal:
            moved = None
        if moved is not None:
            pattern = replace(moved.pattern, edges_assignment=pattern.edges_assignment)
        if self.file.own_layers:
            return self._as_it_says(pattern, found, moved)
        return self._search(pattern, moved)

    def _is_open(self, pattern: CreasePattern, finding: Finding) -> bool:
        """Whether a finding is only about how many mountains and valleys there are, while some edges are unassigned."""
        return finding.check == "maekawa" and bool((pattern.edges_assignment == "U").any())

    def _too_far(self, found: list[Finding], moved: Repaired | None, diagonal: float) -> str:
        """Return why the angles cannot be made exact."""
        if moved is None:
            return f"{found[0]}; no pattern near to it has angles that fold flat"
        x, y = moved.where
        return (
            f"the vertex at ({x:.4g}, {y:.4g}) would have to move by {moved.most:.3g} mm, {moved.most / diagonal:.2g} "
            f"of the sheet, and {self.tolerance:g} is allowed; allow more with --tolerance, or mend the angles there"
        )

    def _as_it_says(self, pattern: CreasePattern, found: list[Finding], moved: Repaired | None) -> Decision:
        """Judge the order of all layers that the file has, with vertices where they were moved to."""
        error = self._error(pattern, moved)
        loose = [times * error / _diagonal(pattern) for times in ERRORS] if error else _loose(pattern)
        tolerances = sorted({*(min(share, LOOSEST) for share in loose), *COINCIDENT}, reverse=True)
        within = verify(with_folds(pattern), self.file.layers, self.shape, tolerances)
        if not within:
            return self._folds("folds flat as the file says", pattern, None, moved)
        found = found if moved is None and found else within  # an unassigned edge may have nothing wrong but its layers
        if {finding.check for finding in found} == {"cut"}:
            return _refused(pattern, f"folds flat, but the cut is not the drawing's: {found[0]}", found)
        return _refused(pattern, f"does not fold flat as the file says: {found[0]}", found)

    def _error(self, pattern: CreasePattern, moved: Repaired | None) -> float:
        """Return by how many mm vertices were moved, here or, within the tolerance, before the file was written."""
        if moved is not None:
            return moved.most
        return min(self.file.repaired_by, self.tolerance * _diagonal(pattern))

    def _search(self, pattern: CreasePattern, moved: Repaired | None) -> Decision:
        """Look for an order that agrees with what the file gives of one."""
        given = given_orders(self.file)
        error = self._error(pattern, moved)
        answer = find_order(pattern, given, error)
        if answer.folds is None:
            assert answer.reason is not None
            return _undecided(pattern, answer.reason.text)
        if not answer.folds:
            return self._refused_order(pattern, answer, given, error)
        findings = verify(
            answer.pattern,
            PairOrder(answer.pairs),
            self.shape,
            tuple(sorted({answer.tolerance, *COINCIDENT}, reverse=True)),
        )
        if {finding.check for finding in findings} == {"cut"}:
            return _refused(answer.pattern, f"folds flat, but the cut is not the drawing's: {findings[0]}", findings)
        if findings:
            return _undecided(
                pattern, f"an order of the layers was found, and the proof does not accept it: {findings[0]}"
            )
        told = "folds flat; the file leaves the layer order open, and one was found"
        if len(given):
            told = "folds flat; the file orders some of the layers, and the others were found"
            if not len(_missing(answer.pairs, given)):
                told = "folds flat as the file says"
        return replace(self._folds(told, answer.pattern, answer.pairs, moved), tolerance=answer.tolerance)

    def _refused_order(self, pattern: CreasePattern, answer: Found, given: Ints, error: float) -> Decision:
        """Return the decision where there is no order, and whether that is the fault of what the file gives of one."""
        assert answer.reason is not None
        finding = Finding("layers", answer.reason.text, answer.reason.place)
        if len(given) and find_order(pattern, NO_PAIRS, error).folds:
            what = "does not fold flat as the file says, though it does in another layer order"
            return _refused(pattern, f"{what}: {finding}", [finding])
        return _refused(pattern, f"does not fold flat: {finding}", [finding])

    def _folds(self, sentence: str, pattern: CreasePattern, pairs: Indices | None, moved: Repaired | None) -> Decision:
        """Return the decision that a pattern folds, unless other fields of the file say something else."""
        fields = judge_fields(self._as_found(pattern, pairs is not None), self._near(pattern, moved))
        if fields:
            return _refused(pattern, f"does not fold flat as the file says: {fields[0]}", fields)
        notes = []
        if moved is not None:
            x, y = moved.where
            share = moved.most / _diagonal(pattern)
            notes.append(
                f"angles fold flat exactly with vertices moved by at most {moved.most:.3g} mm, {share:.2g} of the "
                f"sheet, at ({x:.4g}, {y:.4g})"
            )
        return Decision(True, sentence, pattern, (), pairs, moved, tuple(notes))

    def _as_found(self, pattern: CreasePattern, with_order: bool) -> FoldFile:
        """Return the file with the pattern that was found; what it says about unassigned edges is left out."""
        file, claims = self.file, self.file.claims
        free = file.pattern.edges_assignment == "U"
        letters = {
            name: np.where(free & (others == "U"), pattern.edges_assignment, others)
            for name, others in claims.letters.items()
        }
        angles = {name: np.where(free, np.nan, values) for name, values in claims.angles.items()}
        layers = None if with_order else file.layers
        return replace(file, pattern=pattern, layers=layers, claims=replace(claims, letters=letters, angles=angles))

    def _near(self, pattern: CreasePattern, moved: Repaired | None) -> float:
        """Return how far the vertices of a folded form may be from where the creases put them, in mm."""
        near_mm = FORM * self.tolerance * _diagonal(pattern)
        return near_mm if moved is None else max(near_mm, ERRORS[0] * moved.most)


def given_orders(file: FoldFile) -> Ints:
    """Return the pairs of faces that a file orders, the upper one first, ``(n, 2)``."""
    if file.turned is None:
        return NO_PAIRS
    pattern = with_folds(file.pattern)
    up = fold_faces(pattern, edge_faces(pattern)).up != file.turned
    rows = np.concatenate([NO_ORDERS, *file.claims.orders.values()])
    f, g, side = rows[rows[:, 2] != 0].T
    over = (side > 0) == up[g]
    pairs: Ints = np.stack([np.where(over, f, g), np.where(over, g, f)], axis=1)
    return np.unique(pairs, axis=0)


def _missing(pairs: Indices, given: Ints) -> Indices:
    """Return the pairs that are not among those given."""
    known = set(map(tuple, given.tolist()))
    return pairs[[pair not in known for pair in map(tuple, pairs.tolist())]]


def _loose(pattern: CreasePattern) -> list[float]:
    """Return the tolerances, relative to the diagonal, that distances in the folded pattern suggest."""
    folding, faces = with_folds(pattern), edge_faces(pattern)
    found = tolerances_of(folding, faces, fold_faces(folding, faces))
    return [tolerance / _diagonal(pattern) for tolerance, gap in found if gap >= CLEAR]


def _diagonal(pattern: CreasePattern) -> float:
    return float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))


def _refused(pattern: CreasePattern, sentence: str, findings: list[Finding]) -> Decision:
    return Decision(False, sentence, pattern, tuple(findings))


def _undecided(pattern: CreasePattern, why: str) -> Decision:
    return Decision(None, f"not decided: {why}", pattern)
