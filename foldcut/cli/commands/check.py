"""``foldcut check``: verify a FOLD file, of foldcut's or of any other program."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np

from foldcut.cli import options
from foldcut.cli.commands import Command

EXAMPLES = """\
examples:
  foldcut check fish.fold
  foldcut check star.fold --shape star     also check that the cut gives this shape
  foldcut check fish.fold --json
"""

ANOTHER = 0.1
"""An outline that is farther than this part of a drawing's size from it was not made from that drawing."""


def add_options(command: ArgumentParser) -> None:
    """Add the FOLD file, and the drawing that its cut must give."""
    command.add_argument("file", metavar="FILE.fold", help="the crease pattern")
    command.add_argument("--shape", metavar="SHAPE", help="the drawing that the cut must give, or the name of a sample")
    options.add_reading(command)
    options.add_timeout(command)
    options.add_console(command)


def check(args: Namespace) -> int:
    """Verify a FOLD file."""
    from foldcut.cli import report
    from foldcut.drawing.shape import make_shape
    from foldcut.foldfile.judge import judge
    from foldcut.foldfile.read import read_fold
    from foldcut.redraw.distance import apart

    read = read_fold(Path(args.file))
    shape, notes = None, read.notes
    if args.shape:
        drawing = options.named_source(args.shape).read(options.reading(args))
        notes += drawing.repairs
        if read.placement is not None:
            loops = [read.placement.apply(loop) for loop in drawing.own_coordinates()]
        else:
            loops = [loop * (drawing.unit_mm or 1.0) for loop in drawing.loops]
            notes += ("foldcut:placement is missing: the drawing is taken to lie on the sheet as drawn, in mm, y up",)
        shape = make_shape(loops)
    findings = judge(read, shape)
    checked = report.check_report(read.pattern, findings, shape is not None, notes)
    remedy = "mend the pattern"
    if args.shape:
        remedy += ", or give the drawing it was made from, with no corners moved (foldcut make --exact)"
    if shape is not None and read.loops and any(finding.check == "cut" for finding in findings):
        off = apart(read.loops, shape.loops)
        if off < ANOTHER * float(np.ptp(np.concatenate(shape.loops), axis=0).max()):
            remedy = f"its outline is about {off:.1g} mm off that drawing; foldcut make --exact moves no corner"
    return options.console(args).verdict(checked, report.check_lines(checked), findings, remedy)


CHECK = Command(
    "Verify that a crease pattern folds flat as it says, and with --shape also its cut.", EXAMPLES, add_options, check
)
