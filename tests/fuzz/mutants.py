"""Change finished patterns at random and see that no wrong one is accepted.

``python tests/fuzz/mutants.py [--count 1000] [--seed 1]``. Samples are folded by every method and written as FOLD; each
mutant has one field changed: a vertex, a letter, an edge, a face, the list of layers, the order of faces, an angle, the
folded form, the placement, the shape, the first folds, or what the file says of its drawing. Each is decided as ``check
--shape`` does, and reopened as ``make FILE.fold`` does. One that is accepted has to be right for another reason that is
looked for here, without the verifier: the same pattern in other words, vertices within the tolerance, another outline
of the sheet, or another layer order that ``tests/oracles/slow_layers.py`` accepts, too. All others are printed as wrong
accepts; exit status 1.
"""

from __future__ import annotations

import argparse
import copy
import json
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).parents[1]))
from oracles.slow_layers import slow_check

import foldcut
from foldcut.core.arrays import Ints
from foldcut.core.errors import FoldcutError
from foldcut.core.model import CreasePattern, Shape
from foldcut.drawing.shape import make_shape
from foldcut.exporters import export
from foldcut.foldfile.decide import TOLERANCE, decide
from foldcut.foldfile.read import FoldFile, read_fold
from foldcut.foldfile.reopen import reopen
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

PATTERNS = (
    ("simple", "star"),
    ("mirror", "snowflake"),
    ("mirror", "rosette"),
    ("compact", "fish"),
    ("skeleton", "letter-a"),
    ("skeleton", "two-triangles"),
    ("paper", "triangle"),
    ("gate", "ring"),
)
"""Methods and samples; the last two have thousands of faces."""

SELDOM = 50
"""One of so many mutants is of each pattern with thousands of faces."""

MOST_FACES = 300
"""The slow oracle is not asked about more faces."""

Document = dict[str, Any]
Mutation = Callable[[Document, random.Random], str]


def base(method: str, sample: str) -> Document:
    """Return the FOLD file of a sample."""
    found = foldcut.fold(sample_path(sample), method=method, effort="fast", exact=True)
    document: Document = json.loads(export(found.require_verified(), ".fold", load_profile("plain")))
    return document


def some(random_: random.Random, length: float) -> float:
    """Return a movement: from a ten-thousandth of a length to all of it, either way."""
    return random_.choice((-1, 1)) * length * 10 ** random_.uniform(-4, 0)


def move_vertex(document: Document, random_: random.Random) -> str:
    """Move a vertex, in the pattern only or where it lands, too."""
    at = random_.randrange(len(document["vertices_coords"]))
    dx, dy = some(random_, 100), some(random_, 100)
    document["vertices_coords"][at][0] += dx
    document["vertices_coords"][at][1] += dy
    if random_.random() < 0.5:
        document["file_frames"] = []  # nothing else contradicts it
    return f"vertex {at} by ({dx:.3g}, {dy:.3g})"


def swap_letter(document: Document, random_: random.Random) -> str:
    """Give an edge another letter, and the angle to go with it, or none."""
    at = random_.randrange(len(document["edges_assignment"]))
    old = document["edges_assignment"][at]
    document["edges_assignment"][at] = random_.choice([one for one in "BMVFUC" if one != old])
    document.pop("edges_foldAngle")
    return f"edge {at} from {old} to {document['edges_assignment'][at]}"


def swap_all_letters(document: Document, random_: random.Random) -> str:
    """Swap mountains and valleys of some edges on one line, or of all."""
    edges = [at for at, letter in enumerate(document["edges_assignment"]) if letter in "MV"]
    chosen = edges if random_.random() < 0.2 else random_.sample(edges, random_.randint(2, max(2, len(edges) // 2)))
    for at in chosen:
        document["edges_assignment"][at] = "MV"[document["edges_assignment"][at] == "M"]
    document.pop("edges_foldAngle")
    return f"{len(chosen)} of {len(edges)} letters"


def swap_layers(document: Document, random_: random.Random) -> str:
    """Change the list of layers, and leave the other orders out."""
    layers = document["foldcut:layers"]
    one, other = random_.sample(range(len(layers)), 2)
    how = random_.random()
    if how < 0.5:
        layers[one], layers[other] = layers[other], layers[one]
    elif how < 0.8:
        layers.insert(other, layers.pop(one))
    else:
        low, high = sorted((one, other))
        layers[low : high + 1] = layers[low : high + 1][::-1]
    document.pop("faceOrders")
    return f"layers {one} and {other}"


def change_orders(document: Document, random_: random.Random) -> str:
    """Turn a row of faceOrders round, with the list of layers or without."""
    rows = document["faceOrders"]
    if not rows:
        return "no row"
    at = random_.randrange(len(rows))
    rows[at][2] = -rows[at][2]
    if random_.random() < 0.5:
        document.pop("foldcut:layers")
    return f"faceOrders[{at}]"


def change_edge(document: Document, random_: random.Random) -> str:
    """Let an edge end elsewhere, or leave it out."""
    at = random_.randrange(len(document["edges_vertices"]))
    if random_.random() < 0.5:
        document["edges_vertices"][at][random_.randrange(2)] = random_.randrange(len(document["vertices_coords"]))
        return f"an end of edge {at}"
    for name in ("edges_vertices", "edges_assignment", "edges_foldAngle"):
        document[name].pop(at)
    return f"without edge {at}"


def change_face(document: Document, random_: random.Random) -> str:
    """Change a face: another vertex, one fewer, the other way round, or another number."""
    faces = document["faces_vertices"]
    at, other = random_.sample(range(len(faces)), 2)
    how = random_.random()
    if how < 0.3:
        faces[at][random_.randrange(len(faces[at]))] = random_.randrange(len(document["vertices_coords"]))
    elif how < 0.6:
        faces[at].pop(random_.randrange(len(faces[at])))
    elif how < 0.8:
        faces[at], faces[other] = faces[other], faces[at]
    else:
        faces[at].reverse()
    return f"face {at}"


def change_angle(document: Document, random_: random.Random) -> str:
    """Give an edge another fold angle."""
    at = random_.randrange(len(document["edges_foldAngle"]))
    document["edges_foldAngle"][at] = random_.choice((0, 90, -90, 180, -180, 179, 1e9))
    return f"edges_foldAngle[{at}] is {document['edges_foldAngle'][at]}"


def change_form(document: Document, random_: random.Random) -> str:
    """Move a vertex of the folded form."""
    form = document["file_frames"][0]["vertices_coords"]
    at, by = random_.randrange(len(form)), some(random_, 100)
    form[at][random_.randrange(2)] += by
    return f"folded vertex {at} by {by:.3g}"


def change_placement(document: Document, random_: random.Random) -> str:
    """Change where the drawing lies: a number, all turned, or all moved."""
    matrix = document["foldcut:placement"]
    row, column = random_.randrange(2), random_.randrange(3)
    by = some(random_, 1 if column < 2 else 100)
    matrix[row][column] += by
    return f"placement [{row}][{column}] by {by:.3g}"


def change_shape(document: Document, random_: random.Random) -> str:
    """Move a corner of the shape that the file says is cut, or leave one out."""
    loop = random_.choice(document["foldcut:shape"])
    at = random_.randrange(len(loop))
    if random_.random() < 0.3 and len(loop) > 3:
        loop.pop(at)
        return f"without corner {at}"
    by = some(random_, 100)
    loop[at][random_.randrange(2)] += by
    return f"corner {at} by {by:.3g}"


def change_first_folds(document: Document, random_: random.Random) -> str:
    """Give other first folds: moved, more, far away."""
    folds = document["foldcut:firstFolds"]
    line = [[random_.uniform(-50, 350), random_.uniform(-50, 350)] for _ in range(2)]
    if folds and random_.random() < 0.6:
        fold = random_.choice(folds)
        by = some(random_, 100)
        fold[random_.randrange(len(fold))][random_.randrange(2)] += by
        return f"a first fold by {by:.3g}"
    folds.insert(
        random_.randint(0, len(folds)), [[1e6 * x for x in point] for point in line] if len(folds) % 2 else line
    )
    return "one more first fold"


def change_moved(document: Document, random_: random.Random) -> str:
    """Say that vertices or the drawing were moved, and move one of them."""
    document[random_.choice(("foldcut:movedBy", "foldcut:repairedBy"))] = 10 ** random_.uniform(-3, 9)
    return "said to be moved; " + move_vertex(document, random_)


MUTATIONS: tuple[Mutation, ...] = (
    move_vertex, swap_letter, swap_all_letters, swap_layers, swap_layers, change_orders, change_edge, change_face,
    change_angle, change_form, change_placement, change_shape, change_first_folds, change_moved,
)  # fmt: skip


def is_right(file: FoldFile, original: FoldFile, drawing: Shape) -> str:
    """Return why an accepted mutant is right, without asking the verifier; "" if no reason is found."""
    new, old = file.pattern, original.pattern
    same_faces = {tuple(sorted(face)) for face in new.faces_vertices.to_lists()} == {
        tuple(sorted(face)) for face in old.faces_vertices.to_lists()
    }
    same_edges = {tuple(sorted(edge)) for edge in new.edges_vertices.tolist()} == {
        tuple(sorted(edge)) for edge in old.edges_vertices.tolist()
    }
    if not same_faces or not same_edges:
        return ""
    diagonal = float(np.hypot(*np.ptp(old.vertices_coords, axis=0)))
    if _off_its_creases(new, old) > 2 * TOLERANCE * diagonal:
        return ""
    other = new.edges_assignment != old.edges_assignment
    if (other & (new.edges_assignment != "U") & (new.edges_assignment != "F")).any():
        flipped = dict(zip("MV", "VM", strict=True))
        if [flipped.get(one, one) for one in old.edges_assignment.tolist()] != new.edges_assignment.tolist():
            return ""
    if file.loops is not None and not _same_area(
        [loop.tolist() for loop in file.loops], drawing, 2 * diagonal * TOLERANCE
    ):
        return "" if file.moved_by is None else "the file says that its outline was moved"
    is_new = file.layers is not None and (other.any() or file.layers.tolist() != _layers_of(original).tolist())
    if is_new and (len(new.faces_vertices) > MOST_FACES or slow_check(new, _layers_of(file))):
        return ""
    return "the same pattern in other words, or in another order that folds"


def _off_its_creases(new: CreasePattern, old: CreasePattern) -> float:
    """Return how far vertices were moved, in mm; those on the border may go along their creases: another sheet."""
    by = new.vertices_coords - old.vertices_coords
    border = np.unique(old.edges_vertices[old.edges_assignment == "B"])
    free = np.isin(np.arange(len(by)), border)
    most = float(np.hypot(*by[~free].T).max(initial=0.0))
    for one, other in old.edges_vertices[old.edges_assignment != "B"]:
        along = old.vertices_coords[other] - old.vertices_coords[one]
        normal = np.array([-along[1], along[0]]) / np.hypot(*along)
        most = max(most, float(np.abs(by[[one, other]] @ normal).max()))
    return most


def _layers_of(file: FoldFile) -> Ints:
    assert file.layers is not None
    return file.layers


def _same_area(loops: list[list[list[float]]], drawing: Shape, near: float) -> bool:
    one, other = (
        shapely.union_all([shapely.Polygon(loop).boundary for loop in each]) for each in (loops, drawing.loops)
    )
    return bool(shapely.hausdorff_distance(one, other) <= near)


def judged(document: Document, original: FoldFile, drawing: Shape, folder: Path) -> tuple[str, str]:
    """Return what becomes of a mutant, "refused", "not decided", "right" or "WRONG", and why."""
    path = folder / "mutant.fold"
    path.write_text(json.dumps(document))
    try:
        file = read_fold(path)
    except FoldcutError as error:
        return "refused", str(error)
    try:
        opened = reopen(file)
        first_folds = opened.folded_pattern.first_folds if not opened.findings else ()
    except FoldcutError:
        first_folds = ()
    wanted = {np.round(fold, 3).tobytes() for fold in original.first_folds or ()}
    if any(np.round(fold, 3).tobytes() not in wanted for fold in first_folds):
        return "WRONG", "a first fold that the pattern does not have is kept"
    decision = decide(file, drawing)
    if not decision.folds:
        return ("not decided" if decision.folds is None else "refused"), decision.sentence
    reason = is_right(file, original, drawing)
    return ("right", reason) if reason else ("WRONG", decision.sentence)


def main() -> int:
    """Judge mutants of all patterns; return 1 if a wrong one is accepted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    random_, told = random.Random(args.seed), Counter[tuple[str, str]]()
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bases = []
        for method, sample in PATTERNS:
            document = base(method, sample)
            (folder / "base.fold").write_text(json.dumps(document))
            original = read_fold(folder / "base.fold")
            assert original.loops is not None
            bases.append((f"{method} {sample}", document, original, make_shape(original.loops)))
            print(f"{bases[-1][0]}: {len(document['faces_vertices'])} faces", flush=True)
        for number in range(args.count):
            large = {SELDOM - 1: -1, SELDOM // 2: -2}.get(number % SELDOM)
            what, document, original, drawing = bases[number % (len(bases) - 2) if large is None else large]
            mutation, mutant = random_.choice(MUTATIONS), copy.deepcopy(document)
            changed = mutation(mutant, random_)
            outcome, why = judged(mutant, original, drawing, folder)
            told[mutation.__name__, outcome] += 1
            if number % 100 == 99:
                print(f"{number + 1} mutants", flush=True)
            if outcome == "WRONG":
                wrong += 1
                print(f"{outcome} {number} {what}: {mutation.__name__}: {changed}: {why}", flush=True)
    for (mutation_name, outcome), times in sorted(told.items()):
        print(f"{mutation_name:<20} {outcome:<12} {times}")
    print(f"{args.count} mutants, {wrong} wrong accepts")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
