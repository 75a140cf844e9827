"""Folds the drawings of the gallery: ``make gallery`` runs it.

It writes each sheet, guide and animation into out/gallery/, and docs/gallery.md with a small picture of each pattern,
the easiest first.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from foldcut import fold
from foldcut.exporters.pictures.contact_sheet import contact_sheet, thumbnail
from foldcut.profiles import load_profile

DOCS = Path(__file__).resolve().parent.parent
PAGE, PICTURES = DOCS / "gallery.md", DOCS / "gallery"
OUT = DOCS.parent / "out" / "gallery"

NAMES = (
    *("arrow", "bat", "bell", "boat", "butterfly", "candle", "cat", "crown", "fish", "ghost", "heart", "leaf"),
    *("letter-a", "letter-h", "letter-l", "letter-m", "mushroom", "pumpkin", "rabbit", "rocket", "snowflake", "star"),
    *("tree", "whale"),
)
"""The samples of the gallery."""

COLUMNS = 4

HEAD = """# Gallery

Twenty-four samples that people fold, the easiest first. `make gallery` writes the sheet to print, the guide and an
animation of each into out/gallery/, and this page; some minutes. One of them alone:

```sh
foldcut make bat -o bat.pdf                 # the sheet, to print in true size
foldcut guide bat                           # bat-guide.pdf, step by step
foldcut guide bat -o bat.svg                # it moves
```

![A star is folded, cut and unfolded](star-folds.svg)

"""


class Made(NamedTuple):
    """What the page says of a sample: what rows are sorted by comes first."""

    level: int
    minutes: int
    folds: int
    name: str
    difficulty: str

    @property
    def cell(self) -> str:
        """The cell of the table."""
        picture = f"[![{self.name}](gallery/{self.name}.svg)](gallery/{self.name}.svg)"
        return f"{picture}<br>`{self.name}`: {self.folds} folds<br>{self.difficulty}"


def made(name: str) -> Made:
    """Fold a sample and write its files."""
    for folder in (OUT, PICTURES):
        folder.mkdir(parents=True, exist_ok=True)
    result = fold(name)
    result.save(OUT / f"{name}.pdf", force=True)
    result.save_guide(OUT / f"{name}-guide.pdf", force=True)
    result.save_guide(OUT / f"{name}-folds.svg", force=True)
    picture, _ = contact_sheet([(result.title, thumbnail(result.folded_pattern))], "", load_profile().drawing)
    (PICTURES / f"{name}.svg").write_bytes(picture)
    hard = result.difficulty
    print(f"{name}: {result.folds} folds, {hard}", flush=True)
    return Made(hard.level, hard.minutes or 0, result.folds, name, hard.short)


def page(rows: Iterable[Made]) -> str:
    """Return the page."""
    cells = [row.cell for row in sorted(rows)]
    lines = [cells[start : start + COLUMNS] for start in range(0, len(cells), COLUMNS)]
    table = [["   "] * COLUMNS, ["---"] * COLUMNS, *lines]
    return HEAD + "\n".join(f"| {' | '.join(line)} |" for line in table) + "\n"


def main() -> None:
    """Write the files and the page."""
    PAGE.write_text(page([made(name) for name in NAMES]), "utf-8")


if __name__ == "__main__":
    main()
