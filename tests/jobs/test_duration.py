"""How long jobs take: against moves computed by hand, and against a path walked in small steps."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from support.folded import folded_sample

from foldcut.core.arrays import Floats
from foldcut.jobs.duration import about, seconds_of_moves, seconds_of_steps
from foldcut.jobs.job import Job, JobStep, make_jobs
from foldcut.profiles import load_profile, profile_names

MACHINES = [name for name in profile_names() if load_profile(name).operations]
SPEED, ACCELERATION, CORNER = 50.0, 1000.0, 0.01


def moves(points: list[tuple[float, float]], stops: list[bool] | None = None, speed: Any = SPEED) -> Floats:
    count = len(points) - 1
    return seconds_of_moves(
        np.array(points, dtype=np.float64),
        np.full(count, speed, dtype=np.float64),
        np.array([False] * count if stops is None else stops),
        ACCELERATION,
        CORNER,
    )


def test_a_long_move_is_a_trapezoid() -> None:
    # 0.05 s and 1.25 mm to get to 50 mm/s, as much to stop, and 97.5 mm in between
    assert moves([(0, 0), (100, 0)]) == pytest.approx([0.05 + 97.5 / 50 + 0.05])


def test_a_short_move_is_a_triangle() -> None:
    # half of 1 mm at 1000 mm/s2 takes sqrt(2 * 0.5 / 1000) s
    assert moves([(0, 0), (0, 1)]) == pytest.approx([2 * math.sqrt(0.001)])


def test_straight_on_is_one_move_unless_the_tool_stops() -> None:
    assert moves([(0, 0), (40, 30), (80, 60)]).sum() == pytest.approx(2.05)
    assert moves([(0, 0), (40, 30), (80, 60)], [True, False]).sum() == pytest.approx(2 * 1.05)
    # a move of no length between them changes nothing
    assert moves([(0, 0), (40, 30), (40, 30), (80, 60)]).sum() == pytest.approx(2.05)
    assert moves([(0, 0), (40, 30), (40, 30), (80, 60)], [False, True, False]).sum() == pytest.approx(2 * 1.05)


def test_a_corner_is_as_slow_as_grbl_goes_through_it() -> None:
    # 90 degrees: the square of the speed is a d s / (1 - s) for s = sin 45 degrees: 4.913 mm/s
    through = math.sqrt(1000 * 0.01 * math.sqrt(0.5) / (1 - math.sqrt(0.5)))
    assert through == pytest.approx(4.913, abs=1e-3)
    # 0.05 s and 1.25 mm from rest to 50 mm/s, and from there to the corner's speed a little less
    slower, way = (50 - through) / 1000, (50**2 - through**2) / 2000
    assert moves([(0, 0), (100, 0), (100, 100)]) == pytest.approx(2 * [0.05 + slower + (100 - 1.25 - way) / 50])
    # back the way it came, it stops
    assert moves([(0, 0), (100, 0), (0, 0)]).sum() == pytest.approx(2 * 2.05)


def walked(points: Floats, speed: Floats, stops: list[bool]) -> float:
    """The time of the same moves by walking along them in steps of a hundredth of a mm at most."""
    most, ends = [], [0.0]
    for place, (a, b) in enumerate(pairwise(points)):
        steps = math.ceil(math.dist(a, b) / 0.01)
        most += [(math.dist(a, b) / steps, float(speed[place]))] * steps
        corner = 0.0
        if place + 2 < len(points) and not stops[place]:
            u, v = (b - a) / math.dist(a, b), (points[place + 2] - b) / math.dist(points[place + 2], b)
            half = math.cos(math.acos(min(1.0, max(-1.0, float(u @ v)))) / 2)
            corner = 1e9 if half > 1 - 1e-9 else math.sqrt(ACCELERATION * CORNER * half / (1 - half))
        ends += [1e9] * (steps - 1) + [corner]
    fast = [0.0]
    for (step, limit), end in zip(most, ends[1:], strict=True):
        fast.append(min(limit, end, math.sqrt(fast[-1] ** 2 + 2 * ACCELERATION * step)))
    for k in range(len(most) - 1, -1, -1):
        fast[k] = min(fast[k], most[k][1], math.sqrt(fast[k + 1] ** 2 + 2 * ACCELERATION * most[k][0]))
    return sum(2 * step / (fast[k] + fast[k + 1]) for k, (step, _) in enumerate(most))


@pytest.mark.parametrize("seed", range(4))
def test_any_path_takes_as_long_as_when_walked_in_small_steps(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = np.cumsum(random.normal(size=(25, 2)) * random.choice([0.3, 3, 30], size=(25, 1)), axis=0)
    speed, stops = random.choice([20.0, 50.0, 120.0], size=24), random.random(24) < 0.2
    exact = seconds_of_moves(points, speed, stops, ACCELERATION, CORNER).sum()
    assert walked(points, speed, stops.tolist()) == pytest.approx(exact, rel=5e-3)


def job_of(*strokes: list[tuple[float, float]], machine: str = "grbl-laser", at: tuple[float, float] = (0, 0)) -> Job:
    profile = load_profile(machine)
    setting = profile.materials["paper-80g"].cut
    step = JobStep("cut", profile.operations["cut"], setting, tuple(np.array(one, dtype=float) for one in strokes))
    return Job("by hand", (100, 100), at, False, "both", (step,), 0.0, 0.0)


def test_the_way_to_the_strokes_and_back_and_each_pass_count() -> None:
    profile = load_profile("grbl-laser")  # 100 mm/s between strokes, 50 mm/s to cut
    (once,) = seconds_of_steps(job_of([(0, 0), (100, 0)]), profile) or ()
    # 2.05 s without the end, at which it turns back: it goes home at up to 100 mm/s
    assert once == pytest.approx(0.05 + 97.5 / 50 + 0.05 + 0.1 + 90 / 100 + 0.1)
    (moved,) = seconds_of_steps(job_of([(0, 0), (100, 0)], at=(50, 0)), profile) or ()
    assert moved > once + 1
    twice = load_profile("grbl-laser", ["materials.paper-80g.cut.passes=2"])
    job = job_of([(0, 0), (100, 0)])
    setting = twice.materials["paper-80g"].cut
    (both,) = seconds_of_steps(replace(job, steps=(replace(job.steps[0], setting=setting),)), twice) or ()
    assert both == pytest.approx(2 * once)


def test_every_lift_is_a_stop_and_takes_its_time() -> None:
    strokes = [(10.0, 0.0), (20.0, 0.0)], [(30.0, 0.0), (40.0, 0.0)]
    job = job_of(*strokes, machine="axidraw-a4")
    profile = load_profile("axidraw-a4", ["motion.lift_s=0.5"])
    (slow,) = seconds_of_steps(job, profile) or ()
    (quick,) = seconds_of_steps(job, load_profile("axidraw-a4", ["motion.lift_s=1e-9"])) or ()
    assert slow - quick == pytest.approx(4 * 0.5)
    (never,) = seconds_of_steps(job, load_profile("axidraw-a4", ["motion.lift_s=0"])) or ()
    assert never < quick - 0.1  # it does not stop


def test_pens_of_gcode_take_their_own_time() -> None:
    job = job_of([(10.0, 0.0), (20.0, 0.0)], machine="grbl-plotter")
    times = {
        change: seconds_of_steps(job, load_profile("grbl-plotter", [change])) or ()
        for change in ("gcode.pen_up=5", "gcode.pen_up=10", "gcode.draw_mm_s=5")
    }
    # 5 mm more at 10 mm/s down and 100 mm/s up
    assert times["gcode.pen_up=10"][0] - times["gcode.pen_up=5"][0] == pytest.approx(0.5 + 0.05)
    assert times["gcode.draw_mm_s=5"][0] - times["gcode.pen_up=5"][0] > 1
    servo = ["gcode.tool=servo", "gcode.dwell_s=1"]
    longer = seconds_of_steps(job, load_profile("grbl-plotter", [*servo[:1], "gcode.dwell_s=2"])) or ()
    assert longer[0] - (seconds_of_steps(job, load_profile("grbl-plotter", servo)) or ())[0] == pytest.approx(2.0)


@pytest.mark.parametrize("machine", MACHINES)
def test_every_machine_but_a_printer_says_how_long_it_takes(machine: str) -> None:
    profile = load_profile(machine)
    (job,) = make_jobs(folded_sample("star", "180x250mm"), profile)
    seconds = seconds_of_steps(job, profile)
    if profile.kind == "printer":
        assert seconds is None
        return
    assert seconds is not None
    assert len(seconds) == len(job.steps)
    for step, lasts in zip(job.steps, seconds, strict=True):
        speed = profile.motion.work_mm_s if profile.motion is not None else None
        most = step.setting.speed_mm_s if step.setting else speed or (profile.gcode and profile.gcode.draw_mm_s)
        assert lasts > step.length / (most or 0) * (1 if step.setting is None else step.setting.passes)
    assert seconds_of_steps(job, profile.model_copy(update={"motion": None})) is None


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "5 s"), (38, "40 s"), (89, "90 s"), (91, "2 min"), (241, "4 min"), (5399, "1 h 30 min"), (7201, "2 h")],
)
def test_durations_are_told_as_exactly_as_they_are_known(seconds: float, words: str) -> None:
    assert about(seconds) == f"about {words}"
