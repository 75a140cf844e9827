"""No regular expression of foldcut takes long for a long text that is made to have it try many ways.

Every one in the source is found, with the functions that it is used by. From its parts come texts that repeat each
repeatable part, and each beginning of a match, a hundred thousand letters long.
"""

from __future__ import annotations

import ast
import re
import signal
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from re import _constants as sre
from re import _parser
from types import FrameType
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).parent.parent
LETTERS = 100_000
LONGEST_S = 0.5
"""Seconds of the processor for one text: what is linear takes a few thousandths of one."""
FUNCTIONS = ("match", "fullmatch", "search", "sub", "findall", "finditer", "split")
BAD_END = "\0"
"""A letter that no pattern matches at its end."""


class Use(NamedTuple):
    """A regular expression in the source, with the functions that it is used by."""

    where: str
    pattern: str | bytes
    flags: int
    functions: tuple[str, ...]


def sources() -> Iterator[tuple[str, Path]]:
    """Yield the name and the file of each module."""
    for folder in ("foldcut", "exporters", "profiles"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            if "exporters" not in parts[1:] and "profiles" not in parts[1:] and "samples" not in parts[1:]:
                name = ".".join(parts).removesuffix(".__init__")
                yield name if folder == "foldcut" else f"foldcut.{name}", path


def uses() -> list[Use]:
    """Return every regular expression in the source."""
    found = []
    for name, path in sources():
        text = path.read_text("utf-8")
        if "re." not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            called = node.func if isinstance(node, ast.Call) else None
            if not isinstance(called, ast.Attribute) or not isinstance(called.value, ast.Name):
                continue
            if called.value.id != "re" or called.attr not in (*FUNCTIONS, "compile"):
                continue
            assert isinstance(node, ast.Call)
            module = vars(import_module(name))
            pattern = eval(compile(ast.Expression(node.args[0]), str(path), "eval"), dict(module))
            compiled = [one for one in module.values() if isinstance(one, re.Pattern) and one.pattern == pattern]
            functions: tuple[str, ...] = (called.attr,)
            flags = 0
            if called.attr == "compile":
                assert compiled, f"{path}:{node.lineno}: keep it in a name of the module, so that it is tested"
                flags = compiled[0].flags
                names = [key for key, one in module.items() if one is compiled[0]]
                functions = tuple(one for one in FUNCTIONS if any(f"{key}.{one}(" in text for key in names))
                functions = functions or FUNCTIONS
            else:
                flags = re.DOTALL if "re.DOTALL" in ast.unparse(node) else 0
            found.append(Use(f"{name}:{node.lineno}", pattern, flags, functions))
    return found


def example(parsed: Any) -> str:
    """Return a short text that a part of a pattern matches, with what is optional once."""
    return "".join(_example(kind, value) for kind, value in parsed)


def _example(kind: Any, value: Any) -> str:
    if kind in (sre.LITERAL,):
        return chr(value)
    if kind is sre.NOT_LITERAL:
        return "a" if value != ord("a") else "b"
    if kind is sre.ANY:
        return "a"
    if kind is sre.IN:
        return letters(value)[0]
    if kind is sre.BRANCH:
        return example(value[1][0])
    if kind is sre.SUBPATTERN:
        return example(value[3])
    if kind in (sre.MAX_REPEAT, sre.MIN_REPEAT, sre.POSSESSIVE_REPEAT):
        return example(value[2]) * max(value[0], 1)
    if kind is sre.ATOMIC_GROUP:
        return example(value)
    if kind is sre.GROUPREF:
        return '"'
    return ""


def letters(members: Any) -> list[str]:
    """Return letters of a set: one of each kind that it has."""
    space = {sre.CATEGORY_SPACE: " ", sre.CATEGORY_DIGIT: "1", sre.CATEGORY_WORD: "a"}
    if members[0][0] is sre.NEGATE:
        refused = [chr(value) for kind, value in members[1:] if kind is sre.LITERAL]
        return [letter for letter in "a (;*<&/\"'1-" if letter not in refused] or ["z"]
    found = []
    for kind, value in members:
        if kind is sre.LITERAL:
            found.append(chr(value))
        elif kind is sre.RANGE:
            found.append(chr(value[0]))
        else:
            found.append(space.get(value, "!"))
    return found


def attacks(pattern: str | bytes) -> Iterator[str]:
    """Yield texts that make a bad pattern slow: every repeat pumped after what comes before it, and every beginning."""
    text = pattern.decode("latin-1") if isinstance(pattern, bytes) else pattern
    yield from _attacks(list(_parser.parse(text)), "")


def _attacks(parsed: list[Any], before: str) -> Iterator[str]:
    for number, (kind, value) in enumerate(parsed):
        start = before + example(parsed[:number])
        if kind in (sre.MAX_REPEAT, sre.MIN_REPEAT, sre.POSSESSIVE_REPEAT):
            inner = list(value[2])
            pumps = [example(inner)]
            if len(inner) == 1 and inner[0][0] is sre.IN:
                pumps += letters(inner[0][1])
            for pump in filter(None, dict.fromkeys(pumps)):
                yield start + pump * (LETTERS // len(pump))
                yield start + pump * (LETTERS // len(pump)) + BAD_END
            yield from _attacks(inner, start)
        elif kind is sre.SUBPATTERN:
            yield from _attacks(list(value[3]), start)
        elif kind is sre.BRANCH:
            for branch in value[1]:
                yield from _attacks(list(branch), start)
        if whole := start + _example(kind, value):
            yield whole * (LETTERS // len(whole)) + BAD_END
            yield whole + " " * LETTERS + BAD_END


def slow(use: Use) -> str:
    """Return the beginning of a text for which a pattern takes long, or nothing."""

    def late(number: int, frame: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGVTALRM, late)
    compiled = re.compile(use.pattern, use.flags)
    try:
        for text in dict.fromkeys(attacks(use.pattern)):
            subject: Any = text.encode("utf-8") if isinstance(use.pattern, bytes) else text
            for function in use.functions:
                signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST_S)
                started = time.process_time()
                try:
                    if function == "sub":
                        compiled.sub(subject[:0], subject)
                    elif function == "finditer":
                        list(compiled.finditer(subject))
                    else:
                        getattr(compiled, function)(subject)
                except TimeoutError:
                    return f"{function} of {text[:40]!r}... takes over {time.process_time() - started:.1f} s"
                finally:
                    signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    finally:
        signal.signal(signal.SIGVTALRM, before)
    return ""


USES = uses()


def test_the_patterns_of_the_tree_are_found() -> None:
    where = {use.where.partition(":")[0] for use in USES}
    assert len(USES) > 30
    assert {"foldcut.core.units", "foldcut.readers.svg_style", "foldcut.readers.wkb"} <= where


@pytest.mark.parametrize("use", USES, ids=[f"{use.where}-{at}" for at, use in enumerate(USES)])
def test_no_pattern_takes_long_for_a_long_text(use: Use) -> None:
    assert not slow(use)


@pytest.mark.parametrize(
    ("pattern", "function"),
    [
        (r"\s*([0-9]+)\s*(mm)?\s*", "fullmatch"),  # what lengths were read with
        (r"\([^)]*;", "search"),
        (r"/\*.*?\*/", "sub"),
        (r"\s*<\?xml\s[^>]*?\?>", "sub"),
        (r"[0-9]+\.?[0-9]*", "fullmatch"),
        (r"(?:a|ab)*c", "search"),
    ],
)
def test_a_pattern_that_takes_long_is_found(pattern: str, function: str) -> None:
    assert slow(Use("here", pattern, 0, (function,)))
