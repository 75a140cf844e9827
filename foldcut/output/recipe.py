"""The recipe of a file: the drawing's name and hash, the options, and foldcut's version; it is made again from these.

It is the same wherever it is made: files are called by their names, without folders. ``exporters.recipe_place`` says
where it stands in each format.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from typing import Any

from foldcut.core.errors import FileFormatError
from foldcut.core.files import hash_of
from foldcut.exporters.recipe_place import with_recipe
from foldcut.samples import sample_names, sample_path

__all__ = ["Recipe", "read_recipe", "version_now"]

LONGEST = 10_000
"""The most letters of a recipe: as many as a zip archive's comment or a PDF has easily."""


UNNAMED = "drawing"
"""What a drawing is called in a recipe that came from standard input; solve names none."""


def version_now() -> str:
    """Return the version of this foldcut."""
    return version("foldcut")


@dataclass(frozen=True)
class Recipe:
    """How a file was made.

    ``command`` and ``options``: the words of the command line, without its outputs; ``drawing`` and ``sha256``: the
    name and the hash of the drawing's file, "" for a text; ``hashes``: those of other files, by the option that names
    one. ``output``: what the command was told to write; ``file``: what the file was called, which is another name if
    there were several files for one output. ``version``: foldcut's.
    """

    command: str
    options: tuple[str, ...] = ()
    drawing: str = ""
    sha256: str = ""
    hashes: Mapping[str, str] = field(default_factory=dict)
    output: str = ""
    file: str = ""
    version: str = field(default_factory=version_now)

    def also(self, options: tuple[str, ...], hashes: Mapping[str, str]) -> Recipe:
        """Return the recipe with more options, and the hashes of the files that they name."""
        return replace(self, options=self.options + options, hashes={**self.hashes, **hashes})

    def without(self, names: tuple[str, ...]) -> Recipe:
        """Return the recipe without the options of these names."""
        return replace(self, options=tuple(word for word in self.options if word.partition("=")[0] not in names))

    def lines(self) -> list[str]:
        """Return how the file was made as lines for people."""
        made_of = [self.typed_drawing()] if self.drawing or self.command == "solve" else []
        lines = [f"Made by foldcut {self.version}: {shlex.join(['foldcut', self.command, *made_of, *self.options])}"]
        return [*lines, f"SHA-256 of {self.drawing}: {self.sha256}"] if self.sha256 else lines

    def typed_drawing(self) -> str:
        """Return the drawing as it is typed: "-" for standard input, "star" for a sample, "./--a.svg" for --a.svg."""
        if self.drawing in ("", UNNAMED):
            return "-"
        sample = self.drawing.rpartition(".")[0]
        if sample in sample_names(lines=True):
            path = sample_path(sample)
            if path.name == self.drawing and hash_of(path) == self.sha256:
                return sample
        return f"./{self.drawing}" if self.drawing.startswith("-") else self.drawing

    def text(self) -> str:
        """Return the recipe as one line of JSON in ASCII; what is empty is left out."""
        entries: dict[str, Any] = {
            "foldcut": self.version,
            "command": self.command,
            "drawing": self.drawing,
            "sha256": self.sha256,
            "options": [word.removeprefix("--") for word in self.options],
            "hashes": dict(self.hashes),
            "output": self.output,
            "file": "" if self.file == self.output else self.file,
        }
        return json.dumps({key: value for key, value in entries.items() if value}, separators=(",", ":"))

    def put_into(self, data: bytes, output: str, file: str) -> bytes:
        """Return the bytes of a ``file`` that was made for an ``output`` with this recipe in them, if there is room."""
        suffix = "." + file.rpartition(".")[2]
        return with_recipe(data, suffix, replace(self, output=output, file=file).text())


def read_recipe(text: str) -> Recipe:
    """Return the recipe that ``Recipe.text`` wrote; raises FileFormatError if it is none.

    Whoever sent the file may have written it: names have no folders, and options are words with a value or none.
    """
    try:
        entries = json.loads(text) if len(text) <= LONGEST else None
    except (ValueError, RecursionError):
        entries = None
    if not isinstance(entries, dict):
        raise FileFormatError("its recipe is damaged")
    names = {"command", "drawing", "sha256", "output", "file"}
    words = {name: entries.get(name, "") for name in names} | {"version": entries.get("foldcut", "")}
    options, hashes = entries.get("options", []), entries.get("hashes", {})
    if not (
        all(isinstance(word, str) for word in words.values())
        and isinstance(options, list)
        and isinstance(hashes, dict)
        and all(isinstance(word, str) for word in [*options, *hashes, *hashes.values()])
    ):
        raise FileFormatError("its recipe is damaged")
    return Recipe(
        options=tuple(f"--{word}" for word in options),
        hashes=hashes,
        **{**words, "file": words["file"] or words["output"]},
    )
