"""The data of a job: what a machine does to the sheet, step after step; ``job`` makes it.

Lengths are mm, y points up, and (0, 0) is the lower left corner of the sheet as it lies on the bed (``bed``), or of the
bed itself where ``arrange`` has laid sheets on it; ``Job.at`` says where on the bed that is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.jobs.bed import Box, Side, TurnedOver
from foldcut.jobs.tabs import Tabs
from foldcut.profiles import Action, Operation, Profile, Registration, Role, Setting

__all__ = ["Hint", "Job", "JobStep", "Pictogram", "operation_after", "operation_for"]


@dataclass(frozen=True, eq=False)
class JobStep:
    """The strokes of one role, ``(n, 2)`` each, in the order and the direction in which they are made.

    ``operation`` says what the machine calls the role; ``setting`` is None where the material has none for it.
    ``action``: what is done with the strokes; ``words``: what is said of them if their role does not say it all.
    """

    role: Role
    operation: Operation
    setting: Setting | None
    strokes: tuple[Floats, ...]
    action: Action = "mark"
    words: str = ""

    @property
    def length(self) -> float:
        """The length of all strokes in mm."""
        return float(sum(np.hypot(*np.diff(stroke, axis=0).T).sum() for stroke in self.strokes))


Pictogram = Literal["first", "press", "fold", "flatten", "cut"]
"""What a hint on a printed sheet has a small picture of."""


@dataclass(frozen=True)
class Hint:
    """A short line on what a person does with a printed sheet, and the picture beside it."""

    picture: Pictogram
    words: str


@dataclass(frozen=True, eq=False)
class Job:
    """Everything that is done to one side of a sheet.

    ``size``, ``at``, ``turned`` and ``paper`` are those of the ``Lay``; ``travel_before`` and ``travel``: how far the
    tool moves between strokes, in mm, in the pattern's own order and in the job's. ``turned_over``: how the sheet is
    turned over between the front and the back, and what ``registration`` lines them up; ``holes``: the centres of
    registration holes, ``(3, 2)`` for each sheet. ``missed``: how wide the margins are that the machine does not
    reach, at the left, lower, right and upper edge; ``uncut``: how many creases are too short to perforate. ``tabs``
    hold the sheet.
    ``corners``: where sheets lie on the bed that the job is as large as, counted from the bed's zero; empty if it is as
    large as its one sheet. ``framed``: whether a file beside it goes round it first, with the tool off. ``subtitle``
    and ``hints``: what a printed sheet says of how difficult it is, and what to do; none for other machines.
    """

    title: str
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool
    side: Side
    steps: tuple[JobStep, ...]
    travel_before: float
    travel: float
    paper: str | None = None
    turned_over: TurnedOver | None = None
    registration: Registration | None = None
    holes: Floats | None = None
    missed: Box = (0.0, 0.0, 0.0, 0.0)
    uncut: int = 0
    tabs: Tabs | None = None
    corners: tuple[tuple[float, float], ...] = ()
    framed: bool = False
    subtitle: str = ""
    hints: tuple[Hint, ...] = ()

    @property
    def box(self) -> tuple[Floats, Floats]:
        """The lower left and the upper right corner, on the bed, of the rectangle around all strokes."""
        points = np.concatenate([stroke for step in self.steps for stroke in step.strokes]) + self.at
        return points.min(axis=0), points.max(axis=0)


def operation_for(profile: Profile, role: Role, action: Action) -> Operation:
    """Return what a machine calls the lines of a role; perforations are cut with the tool for cuts."""
    operation = profile.operations[role]
    if action != "perforate" or profile.draws:
        return operation
    return operation.model_copy(update={"pen": profile.operations["cut"].pen})


def operation_after(before: JobStep | None, profile: Profile, role: Role, action: Action) -> Operation:
    """Return what a machine calls the lines of a role after another step, with a pause in the name if pens change."""
    operation = operation_for(profile, role, action)
    if before is None or not profile.pause_prefix or operation.pen == before.operation.pen:
        return operation
    return operation.model_copy(update={"layer": profile.pause_prefix + operation.layer})
