"""The whole way from a drawing to a verified pattern."""

from __future__ import annotations

import dataclasses
import os

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import cross, rectangle, regular, simple_polygons, star, star_shaped, two_opt

import foldcut
from foldcut.samples import sample_names, sample_path
from foldcut.shape import make_shape
from foldcut.verify import verify

SEVERAL_LOOPS = {"letter-a", "ring", "two-triangles"}
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


@pytest.mark.parametrize("name", sorted(set(sample_names()) - SEVERAL_LOOPS))
def test_every_sample_with_one_loop_is_verified(name: str) -> None:
    result = foldcut.fold(sample_path(name), "a4")
    assert result.findings == ()
    assert result.folded_pattern.creases.crease_count > 0


@pytest.mark.parametrize("name", sorted(SEVERAL_LOOPS))
def test_samples_with_several_loops_are_refused_by_name(name: str) -> None:
    with pytest.raises(foldcut.UnfoldableError, match="loop 1 .*loop 2 "):
        foldcut.fold(sample_path(name))


@pytest.mark.parametrize("name", ["star", "triangle", "swan"])
def test_a_ribbon_is_verified_too(name: str) -> None:
    result = foldcut.fold(sample_path(name), ribbon=0.5)
    assert result.findings == ()
    assert np.abs(result.folded_pattern.folded.vertices_coords[:, 1]).min() == pytest.approx(0.5)


@pytest.mark.parametrize("name", SYMMETRIC)
def test_symmetric_shapes_with_exact_coordinates_are_verified(name: str) -> None:
    assert foldcut.fold([SYMMETRIC[name]]).findings == ()


def random_polygon(seed: int) -> np.ndarray:
    """Every other one star-shaped and found by 2-opt moves, 4 to 60 corners."""
    rng = np.random.default_rng(seed)
    return np.array((star_shaped, two_opt)[seed % 2](rng, int(rng.integers(4, 61))))


@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_polygons_are_verified_wherever_and_however_large_they_are_drawn(seed: int) -> None:
    polygon = random_polygon(seed)
    result = foldcut.fold([polygon])
    assert result.findings == ()
    for name, (linear, shift, rotation) in VARIANTS.items():
        moved = foldcut.fold([polygon @ linear + shift], rotation=rotation)
        assert moved.findings == (), name
        assert moved.folded_pattern.creases.crease_count == result.folded_pattern.creases.crease_count, name
    # and turned on the sheet: another pattern
    assert foldcut.fold([polygon], rotation=17).findings == ()


@settings(max_examples=25, deadline=None)
@given(polygon=simple_polygons())
def test_any_polygon_is_verified_or_refused_with_a_reason(polygon: list[tuple[float, float]]) -> None:
    try:
        result = foldcut.fold([polygon])
    except foldcut.BadInputError as error:
        assert len(str(error)) > 20
    else:
        assert result.findings == ()


@pytest.fixture(scope="module")
def fish() -> foldcut.Result:
    return foldcut.fold(sample_path("fish"))


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


def test_progress_names_the_stages_and_ends_at_one(fish: foldcut.Result) -> None:
    seen: list[tuple[str, float]] = []
    foldcut.fold([star(5, 0.4)], progress=lambda stage, part: seen.append((stage, part)))
    assert list(dict.fromkeys(stage for stage, _ in seen)) == [stage for stage in fish.seconds if stage != "build"]
    assert seen[-1] == ("verify", 1.0)


def test_the_placement_takes_the_drawing_to_the_sheet(fish: foldcut.Result) -> None:
    from foldcut.readers import read_shape

    pattern = fish.folded_pattern
    loop = pattern.placement.apply(np.array(read_shape(sample_path("fish")).loops[0]))
    distance = np.abs(loop[:, None] - pattern.shape.loops[0][None]).max(axis=2).min(axis=1)
    assert distance.max() < 1e-9


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"method": "magic"}, "unknown method 'magic'; known: paper"),
        ({"ribbon": -1.0}, "half-width is -1.0 mm"),
        ({"ribbon": float("nan")}, "half-width is nan mm"),
        ({"ribbon": 50.0}, "largest half-width that works"),
        ({"sheet": "a99"}, "a99"),
        ({"margin": 200.0}, "margin"),
        ({"scale": 1e6}, "fit"),
    ],
)
def test_bad_arguments_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(foldcut.BadInputError, match=message):
        foldcut.fold([star(5, 0.4)], **arguments)  # type: ignore[arg-type]
