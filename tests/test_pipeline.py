"""The whole way from a drawing to a verified pattern."""

from __future__ import annotations

import dataclasses
import os

import numpy as np
import pytest
from hypothesis import given, settings
from support.folded import fold_sample
from support.samples import TESTED
from support.strategies import cross, rectangle, regular, simple_polygons, star, star_shaped, two_opt

import foldcut
from foldcut.drawing.shape import make_shape
from foldcut.methods import CHOICES
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

SEVERAL_LOOPS = {"letter-a", "ring", "rosette", "two-triangles"}
RANDOM = int(os.environ.get("FOLDCUT_RANDOM", "24"))  # `make sweep` asks for 300
TURN = np.deg2rad(17)
VARIANTS = {
    "turned by 17 degrees": (np.array([[np.cos(TURN), np.sin(TURN)], [-np.sin(TURN), np.cos(TURN)]]), 0.0, -17.0),
    "a thousand times smaller": (np.eye(2) * 1e-3, 0.0, 0.0),
    "a thousand times larger": (np.eye(2) * 1e3, 0.0, 0.0),
    "moved by 1e4": (np.eye(2), 1e4, 0.0),
}
SYMMETRIC = {
    **{f"regular {n}-gon": regular(n) for n in range(3, 13)},
    **{f"{n}-pointed star {ratio}": star(n, ratio) for n in (3, 4, 5, 6, 8) for ratio in (0.4, 0.6)},
    **{f"{w} x {h} rectangle": rectangle(w, h) for w, h in ((1, 1), (2, 1), (3, 1), (10, 1), (1, 4), (16, 9))},
    "cross": cross(),
}


@pytest.mark.parametrize("method", ["compact", "paper"])
@pytest.mark.parametrize("name", sorted(set(TESTED) - SEVERAL_LOOPS))
def test_every_sample_with_one_loop_is_verified(name: str, method: str) -> None:
    result = fold_sample(name, method=method)
    assert result.findings == ()
    assert result.folded_pattern.creases.crease_count > 0


@pytest.mark.parametrize("method", ["compact", "paper"])
@pytest.mark.parametrize("name", sorted(SEVERAL_LOOPS))
def test_methods_for_one_loop_refuse_several_by_name(name: str, method: str) -> None:
    with pytest.raises(foldcut.UnfoldableError, match="loop 1 .*loop 2 "):
        foldcut.fold(sample_path(name), method=method)


@pytest.mark.parametrize("name", ["star", "triangle", "swan"])
def test_a_ribbon_is_verified_too(name: str) -> None:
    result = foldcut.fold(sample_path(name), method="paper", ribbon=0.5)
    assert result.findings == ()
    assert np.abs(result.folded_pattern.folded.vertices_coords[:, 1]).min() == pytest.approx(0.5)


@pytest.mark.parametrize("name", ["star", "triangle", "swan"])
def test_the_papers_method_without_a_ribbon_has_creases_that_the_cut_would_sever(name: str) -> None:
    result = foldcut.fold(sample_path(name), method="paper", ribbon=0)
    pattern = result.folded_pattern
    assert {finding.check for finding in result.findings} == {"cut"}
    creases = pattern.creases
    on_line = np.isin(creases.edges_assignment, ("M", "V"))
    on_line &= (np.abs(pattern.folded.vertices_coords[creases.edges_vertices, 1]) < 1e-6).all(axis=1)
    middles = creases.vertices_coords[creases.edges_vertices[on_line]].mean(axis=1)
    lengths = np.hypot(*np.diff(creases.vertices_coords[creases.edges_vertices[on_line]], axis=1)[:, 0].T)
    np.testing.assert_allclose([finding.place for finding in result.findings], middles)
    np.testing.assert_allclose([finding.size for finding in result.findings], lengths)
    for where in ("inside", "outside"):
        words = f"{where} the shape, folds onto the cut line"
        assert any(words in finding.message and "would sever" in finding.message for finding in result.findings)


def test_the_papers_method_takes_a_small_ribbon_by_default() -> None:
    result = foldcut.fold(sample_path("star"), method="paper")
    assert result.ribbon == 0.25
    assert result.findings == ()
    needle = foldcut.fold([[(0, 0), (40, 0), (0, 1)]], method="paper")
    assert 0 < needle.ribbon < 0.25
    assert needle.findings == ()


def test_a_crease_that_is_too_short_is_refused_with_place_and_remedies() -> None:
    result = foldcut.fold([rectangle(3, 1)], method="paper")
    shortest = result.foldability
    assert shortest.shortest_crease_mm is not None
    allowed = foldcut.fold([rectangle(3, 1)], method="paper", min_crease=shortest.shortest_crease_mm)
    assert allowed.verified
    wanted = shortest.shortest_crease_mm * 2.5
    with pytest.raises(
        foldcut.CreaseTooShortError, match="use a sheet 2.5 times as large .*--simplify.*--min-crease"
    ) as no:
        foldcut.fold([rectangle(3, 1)], method="paper", min_crease=wanted)
    assert no.value.length == shortest.shortest_crease_mm
    assert no.value.place == shortest.shortest_crease_at
    assert "about 743 x 525 mm" in str(no.value)
    allowance = float(str(no.value).split("--min-crease ")[1].removesuffix("mm"))
    assert foldcut.fold([rectangle(3, 1)], method="paper", min_crease=allowance).verified


def test_a_simplified_shape_is_what_is_folded_and_cut() -> None:
    bumpy = [(0, 0), (50, 0.3), (100, 0), (100, 60), (0, 60)]
    result = foldcut.fold([bumpy], "a4-landscape", scale=1.0, method="paper", simplify=0.5)
    assert result.verified
    assert result.folded_pattern.shape.corner_count == 4
    assert result.notes == ("simplified: 5 -> 4 corners, at most 0.3 mm off",)
    assert foldcut.fold([bumpy], "a4-landscape", scale=1.0, method="paper").notes == ()


@pytest.mark.parametrize("method", [method for method in CHOICES if method != "gate"])  # for several loops
@pytest.mark.parametrize("name", SYMMETRIC)
def test_symmetric_shapes_with_exact_coordinates_are_verified(name: str, method: str) -> None:
    assert foldcut.fold([SYMMETRIC[name]], method=method, effort="fast", min_crease=0).findings == ()


def random_polygon(seed: int) -> np.ndarray:
    """Every other one star-shaped and found by 2-opt moves, 4 to 60 corners."""
    rng = np.random.default_rng(seed)
    return np.array((star_shaped, two_opt)[seed % 2](rng, int(rng.integers(4, 61))))


@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_polygons_are_verified_wherever_and_however_large_they_are_drawn(seed: int) -> None:
    polygon = random_polygon(seed)
    result = foldcut.fold([polygon], method="paper")
    assert result.findings == ()
    for name, (linear, shift, rotation) in VARIANTS.items():
        moved = foldcut.fold([polygon @ linear + shift], rotation=rotation, method="paper")
        assert moved.findings == (), name
        assert moved.folded_pattern.creases.crease_count == result.folded_pattern.creases.crease_count, name
    # and turned on the sheet: another pattern
    assert foldcut.fold([polygon], rotation=17, method="paper").findings == ()


@settings(max_examples=25, deadline=None)
@given(polygon=simple_polygons())
def test_any_polygon_is_verified_or_refused_with_a_reason(polygon: list[tuple[float, float]]) -> None:
    try:
        result = foldcut.fold([polygon], method="paper")
    except foldcut.BadInputError as error:
        assert len(str(error)) > 20
    else:
        assert result.findings == ()


@pytest.fixture(scope="module")
def fish() -> foldcut.Result:
    return foldcut.fold(sample_path("fish"), method="paper")


def test_a_result_cannot_be_changed(fish: foldcut.Result) -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        fish.method = "other"  # type: ignore[misc]
    pattern = fish.folded_pattern
    for array in (pattern.creases.vertices_coords, pattern.creases.edges_vertices, pattern.folded.layers):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_another_shape_is_found_out(fish: foldcut.Result) -> None:
    pattern = fish.folded_pattern
    loop = pattern.shape.loops[0].copy()
    loop[3] += 0.1
    findings = verify(pattern.creases, pattern.folded.layers, make_shape([loop]))
    assert {finding.check for finding in findings} == {"cut"}


def test_an_unverified_pattern_is_not_handed_out(fish: foldcut.Result) -> None:
    broken = dataclasses.replace(fish, findings=(foldcut.Finding("cut", "made up", (1.0, 2.0)),))
    assert not broken.verified
    with pytest.raises(foldcut.VerificationError, match=r"cut at \(1, 2\): made up"):
        broken.require_verified()
    assert fish.require_verified() is fish.folded_pattern


def test_progress_names_the_stages_and_ends_at_one() -> None:
    seen: list[tuple[str, float]] = []
    result = foldcut.fold([star(5, 0.4)], method="paper", progress=lambda stage, part: seen.append((stage, part)))
    assert list(dict.fromkeys(stage for stage, _ in seen)) == [stage for stage in result.seconds if stage != "build"]
    assert seen[-1] == ("verify", 1.0)


LETTER_T = [(0, 9), (0, 7), (3, 7), (3, 0), (5, 0), (5, 7), (8, 7), (8, 9)]


@pytest.mark.parametrize("loop", [LETTER_T, [(0, 0), (9, 1), (7, 6), (2, 4)]])
def test_progress_never_steps_back_from_method_to_method(loop: list[tuple[float, float]]) -> None:
    seen: list[tuple[str, float]] = []
    foldcut.fold([loop], seconds=0.5, progress=lambda stage, part: seen.append((stage, part)))
    parts = [part for _, part in seen]
    assert {"straight skeleton", "searching"} <= {stage for stage, _ in seen}
    assert parts == sorted(parts)
    assert (parts[0], parts[-1]) == (0, 1)
    assert len(set(parts)) > 5


def test_the_placement_takes_the_drawing_to_the_sheet(fish: foldcut.Result) -> None:
    from foldcut.readers import read_shape

    pattern = fish.folded_pattern
    (own,) = read_shape(sample_path("fish")).own_coordinates()
    assert own[:, 1].min() > 0, "an SVG's y points down from its upper edge"
    loop = pattern.placement.apply(own)
    distance = np.abs(loop[:, None] - pattern.shape.loops[0][None]).max(axis=2).min(axis=1)
    assert distance.max() < 1e-9


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"method": "magic"}, "unknown method 'magic'; known: auto, mirror, simple, compact, paper"),
        ({"effort": "none"}, "unknown effort 'none'; known: fast, normal, best"),
        ({"seconds": 0.0}, "time to search is 0.0 s"),
        ({"min_crease": -1.0}, "shortest crease allowed is -1.0 mm"),
        ({"simplify": -1.0}, "tolerance to simplify with is -1.0 mm"),
        ({"simplify": float("nan")}, "tolerance to simplify with is nan mm"),
        ({"ribbon": -1.0}, "half-width is -1.0 mm"),
        ({"ribbon": float("nan")}, "half-width is nan mm"),
        ({"ribbon": 50.0, "method": "paper"}, "largest half-width that works"),
        ({"sheet": "a99"}, "a99"),
        ({"margin": 200.0}, "margin"),
        ({"scale": 1e6}, "fit"),
    ],
)
def test_bad_arguments_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(foldcut.BadInputError, match=message):
        foldcut.fold([star(5, 0.4)], **arguments)  # type: ignore[arg-type]
