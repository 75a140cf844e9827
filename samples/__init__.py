"""The sample drawings that come with foldcut, and where their files are.

All are drawn by hand in mm, with few corners and no thin parts, since small features cost creases. Most are SVG; plus
is JSON loops, and kite is WKT. Those of ``LINES`` are cut along lines that are no outlines; they are JSON, too.
"""

from __future__ import annotations

from importlib.resources import files
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from foldcut.core.errors import BadInputError, FileFormatError

_SUFFIXES = (".svg", ".json", ".wkt")

LINES = ("chessboard", "slit-card", "spiders-web", "stroke-letters", "tangram", "zigzag")
"""The samples with open lines, and with lines that meet and cross."""

_COUNTS = "difficulty.toml"
"""Where what it takes to fold the samples is kept; ``tests/bench/difficulty.py`` writes it."""


class FoldCounts(NamedTuple):
    """What makes a pattern easy or difficult: how many folds, how many of them close together, and so on."""

    folds: int
    together: int
    layers_at_cut: int
    shortest_mm: float


def sample_names(*, lines: bool = False) -> tuple[str, ...]:
    """Return the names of samples, without suffixes, in alphabetical order: outlines, and with ``lines`` all."""
    return tuple(sorted(name for name in _paths() if lines or name not in LINES))


def sample_path(name: str) -> Path:
    """Return the file of a sample; raise BadInputError if ``sample_names`` does not list it."""
    paths = _paths()
    if name not in paths:
        raise BadInputError(f"there is no sample {name!r}; give one of {', '.join(sorted(paths))}")
    return paths[name]


def fold_counts() -> dict[str, FoldCounts]:
    """Return what it takes to fold each sample on A4 by the default command, as it was counted."""
    import tomllib

    text = (Path(str(files(__name__))) / _COUNTS).read_text(encoding="utf-8")
    return {name: FoldCounts(**row) for name, row in tomllib.loads(text).items()}


def drawing_path(name: str | PathLike[str]) -> Path:
    """Return the file that is meant by a path, or by the name of a sample where there is no such file.

    Raises ``FileFormatError`` where there is neither and the name is that of no file, but nearly that of a sample.
    """
    from difflib import get_close_matches

    path, samples = Path(name), _paths()
    if path.exists():
        return path
    if str(name) in samples:
        return samples[str(name)]
    near = [] if path.suffix else get_close_matches(str(name), sorted(samples), n=1)
    if near:
        raise FileFormatError(f"{name}: there is no such file; did you mean the sample {near[0]}?")
    return path


def _paths() -> dict[str, Path]:
    folder = Path(str(files(__name__)))
    return {path.stem: path for path in folder.iterdir() if path.suffix in _SUFFIXES}
