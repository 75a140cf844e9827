"""Files that are made to be slow or large, and what reading them takes.

``python tests/fuzz/hostile.py [NAME ...]``: all kinds whose names begin so, or all. Each file, of up to 20 MiB, is read
as the command line reads it (drawings and fonts: read, mended and checked; patterns: ``check``), in a process of its
own. One line each: size, seconds of the processor with starting Python, megabytes, and what came of it; exit status 1
if one took more than 12 s or 1,100 MB, or ended with anything but a shape, a decision, or an error of one line.
"""

from __future__ import annotations

import io
import json
import math
import os
import random
import resource
import struct
import subprocess
import sys
import tempfile
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path

LONGEST_S, MOST_MB = 12.0, 1100.0
"""What a file may take: 10 s and 1 GiB to read it, and some for Python itself."""

KILLED_S = 60
"""A process is killed after so many seconds of the processor."""

BYTES = 20 * 2**20 - 2000
"""The size of the largest files."""

READ = """
import sys
from foldcut.cli.options import Source
from foldcut.core.errors import FoldcutError
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.shape import make_shape
from foldcut.readers import ReadOptions
from pathlib import Path
path = Path(sys.argv[1])
source = Source(path, "A", str(path)) if path.suffix == ".ttf" else Source(path)
try:
    shape = make_shape(prepare(source.read(ReadOptions()).loops, Preparation()).loops)
    print(f"{len(shape.loops)} loops, {shape.corner_count} corners")
except FoldcutError as error:
    print(f"refused: {error}")
"""
"""Reads a drawing, or draws a letter of a font."""


def fill(unit: str, size: int = BYTES, between: str = "") -> str:
    """Return a text repeated up to a size."""
    return between.join([unit] * (size // (len(unit) + len(between))))


def each(count: int, text: Callable[[int], str]) -> str:
    """Return the texts for 0 to count - 1."""
    return "".join(map(text, range(count)))


# ---- SVG


def svg(body: str) -> str:
    """Return a drawing."""
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">{body}</svg>'


def css(rules: str, body: str) -> str:
    """Return a drawing with a style sheet."""
    return svg(f"<style>{rules}</style>{body}")


RECT, PATH = '<rect width="9" height="9"/>', "M0 0H50V50z"
DEEP = "<g>" * 90 + RECT * 50 + "</g>" * 90


def points(count: int) -> Iterable[str]:
    """Return random points."""
    numbers = random.Random(1)
    return (f"{numbers.random() * 99:.3f},{numbers.random() * 99:.3f}" for _ in range(count))


def clip_paths() -> str:
    """Return clip paths that are clipped by others, twice each."""
    path = '<path clip-path="url(#c{0})" d="M0 0H50V50z"/>'
    first = '<clipPath id="c0"><rect width="50" height="50"/></clipPath>'
    more = "".join(
        f'<clipPath id="c{at}" clip-path="url(#c{at - 1})">{path.format(at - 1) * 2}</clipPath>' for at in range(1, 40)
    )
    shown = each(
        2000, lambda at: f'<g transform="translate({at} 0)"><rect width="60" height="60" clip-path="url(#c39)"/></g>'
    )
    return svg(first + more + shown)


def clones() -> str:
    """Return clones of clones, ten times each."""
    more = each(11, lambda at: f'<g id="a{at + 1}">' + f'<use href="#a{at}"/>' * 10 + "</g>")
    return svg(f'<defs><rect id="a0" width="1" height="1"/>{more}</defs><use href="#a11"/>')


SVGS: dict[str, Callable[[], str]] = {
    "points": lambda: svg(f'<polygon points="{" ".join(points(99_000))}"/>'),
    "rects": lambda: svg(each(199_000, lambda at: f'<rect x="{at % 300}" y="{at // 300}" width=".5" height=".5"/>')),
    "groups": lambda: svg("<g>" * 99 + fill("<g/>") + "</g>" * 99),
    "nested": lambda: svg(fill("<g>", BYTES // 2) + fill("</g>", BYTES // 2)),
    "clones": clones,
    "clip-paths": clip_paths,
    "a-clip-each": lambda: svg(
        each(
            30_000,
            lambda at: (
                f'<clipPath id="c{at}"><circle r="{at % 50 + 1}"/></clipPath>'
                f'<rect clip-path="url(#c{at})" width="60" height="60"/>'
            ),
        )
    ),
    "css-rules": lambda: css(
        each(9900, lambda at: f".c{at} .d{at} {{fill:red}}"),
        '<g class="d1">' + '<rect class="c1" width="1" height="1"/>' * 2000 + "</g>",
    ),
    "css-not": lambda: css(each(6000, lambda at: f"*:not(.c{at}) {{fill:#{at % 999:03d}}}"), RECT * 3000),
    "css-descend": lambda: css("g " * 60 + "h {fill:red}", DEEP),
    "css-siblings": lambda: css(".x ~ " * 14 + ".y {fill:red} " + "g " * 12 + "rect{fill:red}", DEEP),
    "css-has": lambda: css(each(300, lambda at: f"g:has(g:has(.c{at})) {{fill:red}}"), DEEP),
    "css-nth": lambda: css(each(1000, lambda at: f":nth-last-of-type({at}n+1) {{fill:red}}"), RECT * 5000),
    "css-brackets": lambda: css("(" * 2_000_000, RECT),
    "css-braces": lambda: css("a{" + "{" * 900 + fill("b:c;"), RECT),
    "css-commas": lambda: css(fill("a,"), RECT),
    "css-declarations": lambda: css("rect{" + fill("fill:red;") + "}", RECT),
    "css-comments": lambda: css(fill("/*a*/"), RECT),
    "css-strings": lambda: css(fill("'a'"), RECT),
    "css-escapes": lambda: css(fill("\\61 "), RECT),
    "css-long-variable": lambda: svg(
        f'<g style="--a:{"x" * 200_000};">'
        + f'<rect width="9" height="9" style="fill:{"var(--a) " * 900}"/>' * 300
        + "</g>"
    ),
    "css-variables": lambda: svg(
        '<g style="--a:1;'
        + each(12, lambda at: f"--{chr(98 + at)}:" + f"var(--{chr(97 + at)}) " * 10 + ";")
        + '">'
        + '<rect width="9" height="9" style="fill:var(--m)"/>' * 3000
        + "</g>"
    ),
    "style": lambda: svg(f'<rect width="9" height="9" style="{fill("a(b;", BYTES // 2)}"/>'),
    "styles": lambda: svg(each(150_000, lambda at: f'<rect width="9" height="9" style="fill:#{at:06x}"/>')),
    "gradients": lambda: svg(
        '<linearGradient id="g">'
        + "<stop/>" * 900
        + "</linearGradient>"
        + '<rect width="9" height="9" fill="url(#g)"/>' * 20_000
    ),
    "gradient-chain": lambda: svg(
        each(30, lambda at: f'<linearGradient id="g{at}" href="#g{at + 1}"/>')
        + '<rect width="9" height="9" fill="url(#g0)"/>' * 90_000
    ),
    "spaces-in-url": lambda: svg(f'<rect width="9" height="9" fill="url({" " * 200_000}"/>'),
    "dashes": lambda: svg(f'<path d="{PATH}" fill="none" stroke="red" stroke-dasharray="{fill("1 ", 1_000_000)}"/>'),
    "texts": lambda: svg(fill("<text>a</text>") + RECT),
    "title": lambda: svg(f"<title>{fill('a b ')}</title>{RECT}"),
    "attributes": lambda: "<svg " + each(1_500_000, lambda at: f'a{at}="1" ') + f">{RECT}</svg>",
    "names": lambda: svg(each(1_000_000, lambda at: f'<a{at} x="1"/>')),
    "ids": lambda: svg(each(1_000_000, lambda at: f'<g id="i{at}"/>')),
    "transform": lambda: svg(f'<g transform="{fill("scale(1)", 6_000_000)}">{RECT}</g>'),
    "css-transform": lambda: svg(f'<g style="transform:{fill("scale(1) ", 6_000_000)}">{RECT}</g>'),
    "curves": lambda: svg('<path d="M0 0' + "C0 1e9 1e9 1e9 1e9 0" * 16_000 + 'z"/>'),
    "arcs": lambda: svg('<path d="M0 0' + each(14_000, lambda at: f"A{at + 1} 9 3 1 1 {at % 99} {at // 99}") + 'z"/>'),
    "circles": lambda: svg(each(2000, lambda at: f'<circle cx="{at * 0.01}" cy="9" r="{5 + at * 0.001}"/>')),
    "one-circle": lambda: svg('<circle cx="9" cy="9" r="5"/>' * 20_000),
    "white": lambda: svg(
        each(
            20_000,
            lambda at: f'<rect x="{at % 300}" y="{at // 300}" width="5" height="5" fill="{("red", "white")[at % 2]}"/>',
        )
    ),
    "lines": lambda: svg('<path fill="none" stroke="red" d="' + each(24_000, lambda at: f"M{at} 0L{at} 9") + '"/>'),
    "grid": lambda: svg('<path d="' + each(100, lambda at: f"M{at} 0V100H{at}.5V0zM0 {at}H100V{at}.5H0z") + '"/>'),
    "long-number": lambda: svg(f'<rect width="{"9" * 5_000_000}" height="9"/>'),
    "spaces": lambda: svg(RECT + " " * 15_000_000),
    "spaces-before": lambda: " " * 15_000_000 + svg(RECT),
    "entities": lambda: f'<!DOCTYPE svg [<!ENTITY a "{"x" * 9000}">]><svg><title>{"&a;" * 220}</title>{RECT}</svg>',
    "references": lambda: svg(f"<title>{fill('&amp;')}</title>{RECT}"),
    "comments": lambda: svg(fill("<!--a-->") + RECT),
    "instructions": lambda: svg(fill("<?a b?>") + RECT),
    "rings": lambda: svg('<path d="' + each(10_000, lambda at: f"M{at % 100},{at // 100}h.4v.4h-.4z") + '"/>'),
    "boxes": lambda: svg('<g style="transform-box:fill-box;transform:rotate(1deg)">' * 90 + RECT * 3000 + "</g>" * 90),
}

# ---- FOLD

Point = tuple[float, float]


def fold(
    vertices: Iterable[Point], edges: Iterable[list[int]], letters: str, faces: Iterable[list[int]], **more: object
) -> str:
    """Return a FOLD file; without ``faces`` if they are empty."""
    found = list(faces)
    document = {
        "file_spec": 1.1,
        "vertices_coords": list(vertices),
        "edges_vertices": list(edges),
        "edges_assignment": list(letters),
        **({"faces_vertices": found} if found else {}),
        **more,
    }
    return json.dumps(document)


SQUARE: list[Point] = [(0, 0), (1, 0), (1, 1), (0, 1)]
SIDES = [[0, 1], [1, 2], [2, 3], [3, 0]]


def square(**more: object) -> str:
    """Return a square with no creases."""
    return json.dumps({**json.loads(fold(SQUARE, SIDES, "BBBB", [[0, 1, 2, 3]])), **more})


def polygon(corners: list[Point]) -> str:
    """Return a sheet with no creases."""
    count = len(corners)
    return fold(corners, [[at, (at + 1) % count] for at in range(count)], "B" * count, [list(range(count))])


def strip(count: int, letters: str = "MV", **more: object) -> str:
    """Return a strip with pleats."""
    edges = [[2 * at, 2 * at + 1] for at in range(count)]
    edges += [[2 * at + k, 2 * at + 2 + k] for at in range(count - 1) for k in (0, 1)]
    inner = (letters * count)[: count - 2]
    faces = [[2 * at, 2 * at + 2, 2 * at + 3, 2 * at + 1] for at in range(count - 1)]
    return fold(
        ((at, k) for at in range(count) for k in (0, 1)), edges, f"B{inner}B" + "B" * (2 * count - 2), faces, **more
    )


def turning(count: int, turn: float) -> list[Point]:
    """Return points around a circle."""
    return [(math.cos(at * turn), math.sin(at * turn)) for at in range(count)]


def fan(count: int) -> str:
    """Return creases from one point to all corners of a polygon."""
    edges = [[0, at] for at in range(1, count + 1)] + [[at, at % count + 1] for at in range(1, count + 1)]
    faces = [[0, at, at % count + 1] for at in range(1, count + 1)]
    return fold([(0, 0), *turning(count, 2 * math.pi / count)], edges, "MV" * (count // 2) + "B" * count, faces)


def crossing_lines(count: int) -> str:
    """Return lines that all cross lines of the other direction, without faces."""
    ends = [end for at in range(count) for end in ((at, -1), (at, count))]
    ends += [end for at in range(count) for end in ((-1, at + 0.5), (count, at + 0.5))]
    return fold(ends, [[at, at + 1] for at in range(0, len(ends), 2)], "M" * (len(ends) // 2), [])


FOLDS: dict[str, Callable[[], str]] = {
    "brackets": lambda: '{"a":' + "[" * 15_000_000,
    "lists": lambda: '{"a":[' + fill("[]", between=",") + "]}",
    "corners": lambda: square(faces_vertices=[[0, 1, 2, 3] * 1_600_000]),
    "faces": lambda: square(faces_vertices=[[0, 1, 2, 3]] * 1_000_000),
    "crossing-face": lambda: polygon(turning(150_000, 2.4)),
    "crossing-face-2": lambda: polygon([tuple(map(float, one.split(","))) for one in points(150_000)]),  # type: ignore[misc]
    "crossing-lines": lambda: crossing_lines(1500),
    "one-place": lambda: polygon([*SQUARE[:3], *[(0.5, 1e-13 * at) for at in range(100_000)]]),
    "near-points": lambda: polygon([(1e-14 * at, 1e-15 * at * at) for at in range(100_000)] + [(1, 0), (0, 1)]),
    "circle": lambda: polygon(turning(200_000, 2 * math.pi / 200_000)),
    "fan": lambda: fan(60_000),
    "orders": lambda: square(faceOrders=[[0, 0, 1]] * 1_000_000),
    "frames": lambda: square(file_frames=[{"frame_classes": ["foldedForm"]}] * 400_000),
    "letters": lambda: square(edges_assignment=["B"] * 3_000_000),
    "pleats": lambda: strip(700, **{"foldcut:layers": list(range(699))}),
    "roll": lambda: strip(2000, "M"),
    "shape": lambda: square(**{"foldcut:shape": [[(at, at * at % 7) for at in range(50_000)]]}),
    "first-folds": lambda: square(**{"foldcut:firstFolds": [[(0, 0), (1, 1)]] * 300_000}),
    "title": lambda: square(file_title="a b " * 5_000_000),
    "long-number": lambda: square(frame_unit="9" * 15_000_000),
}
PATTERNS: dict[str, Callable[[], str]] = {
    "cp.lines": lambda: each(300_000, lambda at: f"2 {at} 0 {at} 9\n"),
    "cp.crossing": lambda: each(3000, lambda at: f"2 {at} 0 {3000 - at} 9\n"),
    "cp.spaces": lambda: "2" + " " * 15_000_000 + "0 0 9 9\n",
    "opx.lines": lambda: "<java>" + fill('<object class="oripa.OriLineProxy"/>') + "</java>",
}

# ---- fonts and pictures


def font(parts: list[int], corners: int = 3) -> bytes:
    """Return a font with an A that has parts, each of so many of the next, and at last of a contour."""
    from fontTools.fontBuilder import FontBuilder
    from fontTools.pens.ttGlyphPen import TTGlyphPen

    names = [".notdef", "A", *(f"g{at}" for at in range(len(parts)))]
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({65: "A"})
    glyphs = {".notdef": TTGlyphPen(None).glyph()}
    for at, name in enumerate(names[1:]):
        pen = TTGlyphPen(dict.fromkeys(names))
        if at < len(parts):
            for step in range(parts[at]):
                pen.addComponent(f"g{at}", (1, 0, 0, 1, step, 0))
        else:
            pen.moveTo((0, 0))
            for corner in range(1, corners):
                pen.lineTo((corner * 7 % 1000, corner * corner % 999))
            pen.closePath()
        glyphs[name] = pen.glyph()
        for side in ("xMin", "yMin", "xMax", "yMax"):
            setattr(glyphs[name], side, 0)
    builder.setupGlyf(glyphs, calcGlyphBounds=False)
    builder.font.recalcBBoxes = False
    builder.setupHorizontalMetrics(dict.fromkeys(names, (600, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupPost()
    for table in ("maxp", "hhea"):
        builder.font[table].recalc = lambda *_: None
    stream = io.BytesIO()
    builder.save(stream)
    return stream.getvalue()


def jpeg(**how: object) -> bytes:
    """Return a picture of 36 million pixels."""
    from PIL import Image

    stream = io.BytesIO()
    picture = Image.effect_noise((6000, 6000), 120) if how.pop("noise", False) else Image.new("L", (6000, 6000))
    picture.save(stream, "JPEG", **how)  # type: ignore[arg-type]
    return stream.getvalue()[:BYTES]


def png(width: int, height: int, rows: bytes, colours: int = 0, depth: int = 8, more: bytes = b"") -> bytes:
    """Return a picture from its rows; ``more`` chunks come first."""
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colours, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + more + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def chunk(name: bytes, data: bytes) -> bytes:
    """Return a chunk of a PNG."""
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


BINARIES: dict[str, Callable[[], bytes]] = {
    "ttf.deep": lambda: font([20] * 9),
    "ttf.wide": lambda: font([2000, 2000]),
    "ttf.points": lambda: font([], 60_000),
    "ttf.cut-short": lambda: font([], 60_000)[:50_000],
    "jpg.noise": lambda: jpeg(noise=True, quality=20),
    "jpg.progressive": lambda: jpeg(progressive=True),
    "jpg.cut-short": lambda: jpeg()[:9000],
    "png.large": lambda: png(30_000, 30_000, bytes(1000)),
    "png.checker": lambda: png(6300, 6300, (b"\0" + b"\x00\xff" * 3150 + b"\0" + b"\xff\x00" * 3150) * 3150),
    "png.16-bit": lambda: png(6300, 6300, (b"\0" + b"\0\0\xff\xff" * 3150) * 6300, depth=16),
    "png.alpha": lambda: png(6300, 6300, (b"\0" + b"\0\0\0\xff\0\0\0\0" * 3150) * 6300, colours=6),
    "png.text": lambda: png(10, 10, bytes(110), more=chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(900_000_000), 1))),
}

KINDS: dict[str, Callable[[], str | bytes]] = {
    **{f"svg.{name}": make for name, make in SVGS.items()},
    **{f"fold.{name}": make for name, make in FOLDS.items()},
    **PATTERNS,
    **BINARIES,
}
"""By format and name, what makes a file."""


def tried(name: str, folder: Path) -> tuple[bool, str]:
    """Return whether a kind is bounded, and a line about it."""
    suffix = name.partition(".")[0]
    made = KINDS[name]()
    path = folder / f"a.{suffix}"
    path.write_bytes(made if isinstance(made, bytes) else made.encode())
    is_pattern = suffix in ("fold", "cp", "opx")
    command = ["-m", "foldcut.cli", "check", str(path)] if is_pattern else ["-c", READ, str(path)]
    with (folder / "out").open("w+") as out, (folder / "errors").open("w+") as errors:
        process = subprocess.Popen(
            [sys.executable, *command],
            stdout=out,
            stderr=errors,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (KILLED_S, KILLED_S)),
        )
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        errors.seek(0)
        said, wrong = (errors if is_pattern else out).read().strip(), "" if is_pattern else errors.read()
    seconds, megabytes = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
    is_told = (
        process.returncode in (0, 1, 2, 3) and "\n" not in said and not wrong and "a mistake in foldcut" not in said
    )
    is_well = is_told and seconds <= LONGEST_S and megabytes <= MOST_MB
    about = f"{name:<22} {path.stat().st_size:>10,} bytes {seconds:5.1f} s {megabytes:5.0f} MB"
    return (
        is_well,
        f"{about} {'' if is_well else 'WRONG '}status {process.returncode} {said or 'folds'} {wrong[-300:]}"[:300],
    )


def main() -> int:
    """Try kinds of files; return 1 if one is not bounded."""
    wanted = sys.argv[1:] or [""]
    worst = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in KINDS:
            if name.startswith(tuple(wanted)):
                is_well, line = tried(name, Path(folder))
                worst |= not is_well
                print(line, flush=True)
    return int(worst)


if __name__ == "__main__":
    sys.exit(main())
