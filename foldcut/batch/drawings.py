"""The drawings of a batch: which files its inputs name, and what the files made of them are called.

Folders, glob patterns and files -> an ``Item`` for each drawing, sorted, no two with the same stem. A text -> an
``Item`` for each letter.
"""

from __future__ import annotations

import glob
import hashlib
import os
import unicodedata
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from foldcut.batch.journal import JOURNAL
from foldcut.batch.results import CONTACT_SHEET, RESULTS
from foldcut.batch.worker import Task
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.core.files import is_standard_input, read_bytes
from foldcut.readers import READERS


@dataclass(frozen=True)
class Item:
    """A drawing: its file, and its ``stem``, the name of the files made of it without an ending.

    ``data``: the bytes of a drawing that is in no file; ``path`` then only names it and its format. ``letter``: the one
    that this is.
    """

    path: Path
    stem: str
    data: bytes | None = None
    letter: str = ""

    def read(self, most: int) -> tuple[Task | None, str, str]:
        """Return the drawing's task and the hash of its bytes, or None and what went wrong.

        No more is read than it takes to see that the file has more than ``most`` bytes.
        """
        if self.data is not None:
            task = Task(str(self.path), self.stem, self.data, self.letter)
            return task, hashlib.sha256(self.data).hexdigest(), ""
        try:
            data = read_bytes(self.path, most)
        except FileFormatError as error:
            return None, "", f"{self.path}: {error}"
        except OSError as error:
            return None, "", f"{self.path}: {error.strerror}; check the path and its permissions"
        return Task(str(self.path), self.stem, data), hashlib.sha256(data).hexdigest(), ""


def letters_of(text: str, font: str) -> list[Item]:
    """Return a drawing for each letter of a text, once, in the order of the text.

    Raises BadInputError: the text has no letters, or the font lacks one. Raises FileFormatError: there is no such font.
    """
    from foldcut.readers.typed_text import letter_names, letter_svgs

    letters = dict(zip(letter_names(text), "".join(text.split()), strict=True))
    drawn = letter_svgs(text, font)
    return [Item(Path(f"{name}.svg"), name, svg.encode(), letters[name]) for name, svg in drawn.items()]


def find_drawings(inputs: Sequence[str | Path], out: Path) -> list[Item]:
    """Return the drawings that ``inputs`` name, sorted, without those in ``out``.

    A stem is the file's name without its ending, in the folders below the input's. Where two files would share one, as
    ``a.svg`` and ``a.dxf`` do, or ``A.svg`` and ``a.svg`` on a system that ignores case, both keep their endings, and
    where even these are the same a number follows.

    Raises BadInputError: an input does not exist, or there are no drawings.
    """
    found: dict[str, tuple[Path, Path]] = {}
    passed_over = 0
    ours = Path(os.path.realpath(out))
    for text in map(str, inputs):
        for path, relative in _matches(text):
            absolute = Path(os.path.abspath(path))
            if ours not in Path(os.path.realpath(path.parent), path.name).parents:
                found.setdefault(str(absolute), (path, relative))
            else:
                passed_over += 1
    if passed_over and not found:
        raise BadInputError(f"there are no drawings but those in {out}, where files are written to; give another -o")
    if not found:
        raise BadInputError(f"{', '.join(map(str, inputs))}: there are no drawings; they end in {', '.join(READERS)}")
    order = [found[absolute] for absolute in sorted(found, key=lambda absolute: (found[absolute][1], absolute))]
    shared = Counter(_same_name(relative.with_suffix("").as_posix()) for _, relative in order)
    taken = {_same_name(name) for name in (CONTACT_SHEET, Path(RESULTS).stem, Path(JOURNAL).stem)}
    items = []
    for path, relative in order:
        stem = relative.with_suffix("").as_posix()
        if shared[_same_name(stem)] > 1 or _same_name(stem) in taken:
            stem = relative.as_posix()
        unique, number = stem, 1
        while _same_name(unique) in taken:
            number += 1
            unique = f"{stem}-{number}"
        taken.add(_same_name(unique))
        items.append(Item(path, unique))
    return items


def _matches(text: str) -> Iterator[tuple[Path, Path]]:
    """Yield the drawings that one input names, and their paths relative to its folder."""
    place = Path(text)
    if place.is_dir():
        for path in place.rglob("*"):
            relative = path.relative_to(place)
            if path.suffix.lower() in READERS and path.is_file() and not any(p.startswith(".") for p in relative.parts):
                yield path, relative
    elif is_standard_input(place):
        raise BadInputError(f"{text}: a batch cannot read standard input; give files, or the drawing to foldcut make")
    elif place.exists():
        yield place, Path(place.name)
    elif glob.has_magic(text):
        fixed = []
        for part in place.parts[:-1]:
            if glob.has_magic(part):
                break
            fixed.append(part)
        folder = Path(os.path.abspath(Path(*fixed)))
        for name in glob.iglob(text, recursive=True):
            if (path := Path(name)).is_file():
                whole = Path(os.path.abspath(path))  # without "..", which would lead out of OUT
                yield path, whole.relative_to(folder) if folder in whole.parents else Path(whole.name)
    else:
        raise BadInputError(f"{text}: there is no such file or folder; give a folder, a file, or a pattern of names")


def _same_name(text: str) -> str:
    """Return a key that is equal for names that some system takes for the same file."""
    return unicodedata.normalize("NFC", text).casefold()
