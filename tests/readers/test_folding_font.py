"""The font made for folding: what its letters are like, that each needs few folds, and words made of them."""

from __future__ import annotations

import string
from pathlib import Path

import numpy as np
import pytest
import shapely

from foldcut import fold
from foldcut.cli.main import main
from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.drawing.shape import make_shape
from foldcut.readers.folding_font import Glyph, folding_font
from foldcut.readers.typed_text import draw_text, letter_names, letter_svgs

FONT = "foldcut"
MOST_FOLDS = 25
SHORTEST_MM = 3.0
LARGE = string.ascii_uppercase + string.digits
LETTERS = LARGE + string.ascii_lowercase
UPRIGHT = "AHIMOTUVWXY08iovwx"  # the same on the left and on the right
LYING = "BCDEHIKOX038acox"  # the same above and below
TURNED = "HINOSXZ08osxz"  # the same upside down


def drawn(glyph: Glyph) -> Floats:
    return np.concatenate(glyph.loops)


def same_corners(points: Floats, image: Floats) -> bool:
    return all(np.abs(points - corner).max(axis=1).min() < 1e-8 for corner in image)


@pytest.mark.parametrize("letter", LETTERS[::2])  # all of them: tests/bench/redraw.py font
def test_every_letter_takes_few_folds_and_no_short_crease(letter: str) -> None:
    result = fold(draw_text(letter, FONT), "a4", effort="fast", exact=True)
    assert result.verified
    assert result.actions <= MOST_FOLDS
    assert result.foldability.shortest_crease_mm is not None
    assert result.foldability.shortest_crease_mm >= SHORTEST_MM


def test_letters_are_shapes_of_one_height() -> None:
    font = folding_font()
    for letter in LETTERS:
        points = drawn(font.glyphs[letter])
        make_shape(font.glyphs[letter].loops)
        bottom, top = points[:, 1].min(), points[:, 1].max()
        if letter in LARGE:
            assert (top, bottom) == (font.height, 0) or letter == "Q"
        else:
            assert top == {"b": 11, "d": 11, "f": 11, "h": 11, "k": 11, "l": 11, "t": 10, "i": 12, "j": 12}.get(
                letter, 8
            )
            assert bottom == (-4 if letter in "gjpqy" else 0), letter
        assert 0 <= points[:, 0].min() < font.gap, letter
        assert points[:, 0].max() == font.glyphs[letter].width or letter in "1Q"


def test_strokes_are_equally_wide_everywhere() -> None:
    """Little is left of a letter from which more than half a stroke is taken on all sides, and of less, something."""
    font = folding_font()
    for letter in set(LETTERS) - set("KRQ134fgikjty"):  # in these, strokes meet at a slant, or end in a point
        polygon = shapely.Polygon()
        for loop in font.glyphs[letter].loops:
            polygon = polygon.symmetric_difference(shapely.Polygon(loop))
        inside = [polygon.buffer(-part * font.stroke / 2, join_style="mitre").area for part in (0.9, 1.25)]
        assert inside[0] > 0, letter
        assert inside[1] < 0.02 * polygon.area, letter


@pytest.mark.parametrize(
    ("letters", "signs"), [(UPRIGHT, (-1, 1)), (LYING, (1, -1)), (TURNED, (-1, -1))], ids=["upright", "lying", "turned"]
)
def test_symmetric_letters_are_exactly_symmetric(letters: str, signs: tuple[int, int]) -> None:
    for letter in LETTERS:
        points = drawn(folding_font().glyphs[letter])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        image = middle + (points - middle) * signs
        assert same_corners(points, image) == (letter in letters), letter


def test_no_two_letters_are_alike() -> None:
    glyphs = folding_font().glyphs
    shapes = {letter: shapely.MultiPoint(drawn(glyphs[letter])) for letter in LETTERS}
    for letter, points in shapes.items():
        others = [other for other, them in shapes.items() if other != letter and them.equals(points)]
        assert others == []


@pytest.mark.parametrize("letter", ["é", "ß", "&", "字"])
def test_a_letter_that_the_font_lacks_is_an_error_with_what_it_has(letter: str) -> None:
    with pytest.raises(BadInputError, match=r"has no letter .* it has A to Z, a to z, 0 to 9, and - \. !"):
        draw_text(letter, FONT)


@pytest.mark.parametrize("joined", ["bar", "baseline"])
@pytest.mark.parametrize("text", ["FOLD", "HI", "VW 8", "egg"])
def test_joined_letters_are_one_piece(joined: str, text: str) -> None:
    apart, together = draw_text(text, FONT), draw_text(text, FONT, joined=joined)

    def pieces(loops: tuple[Floats, ...]) -> int:
        filled = shapely.Polygon()
        for loop in loops:
            filled = filled.symmetric_difference(shapely.Polygon(loop))
        return len(shapely.get_parts(filled))

    assert pieces(apart.loops) == len(text.replace(" ", ""))
    assert pieces(together.loops) == 1
    bottom = min(loop[:, 1].min() for loop in together.loops)
    assert bottom == (-4 if text == "egg" else -folding_font().stroke if joined == "bar" else 0)


def test_letters_of_a_text_are_named_once_and_no_two_alike_where_case_is_ignored() -> None:
    assert list(letter_svgs("Hello", FONT)) == ["H", "e", "l", "o"]
    assert letter_names("Hello") == ["H", "e", "l", "l", "o"]
    assert letter_names("LAlA a1!") == ["L", "A", "l-small", "A", "a-small", "1", "exclamation-mark"]


def test_two_small_letters_fold_on_one_sheet_and_joined_needs_a_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["make", "--text", "LI", "--font", FONT, "--joined", "bar", "--exact", "--effort", "fast", "-o", "li.fold"]
    assert main(words) == 0
    assert Path("li.fold").exists()
    assert main(["make", "fish", "--joined", "bar"]) == 2
    assert "--joined joins the letters of a --text" in capsys.readouterr().err


def test_a_word_that_does_not_fold_names_the_command_that_folds_its_letters(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["make", "--text", "AB", "--font", FONT, "--exact", "--effort", "fast", "--min-crease", "90mm"]
    assert main(words) == 1
    assert "fold the letters one by one: foldcut batch --text AB --font foldcut -o letters" in capsys.readouterr().err
    assert main([*words[:2], "A", *words[3:]]) == 1
    assert "one by one" not in capsys.readouterr().err
