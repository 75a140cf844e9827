"""How long a job takes: the time of every move of the tool, as a motion controller plans it.

``Job`` and ``Profile`` -> seconds for each step, or None where the profile does not say how fast its machine is. The
tool begins and ends at the bed's zero. It gets faster and slower at one acceleration, and goes through a corner as fast
as GRBL does: as on a circle that strays from the corner by no more than ``motion.corner_mm`` (GRBL 1.1, ``planner.c``).
A tool that is lifted stops for that. Not in it: time to change pens, and whatever the machine's software does before.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Bools, Floats
from foldcut.jobs.job import Job, JobStep
from foldcut.profiles import Motion, Profile

__all__ = ["about", "seconds_of_moves", "seconds_of_steps"]

SHORTEST_MOVE_MM = 1e-9
"""A shorter move is none."""


def seconds_of_steps(job: Job, profile: Profile) -> tuple[float, ...] | None:
    """Return how long each step of a job takes in seconds, with the way to its strokes and between them.

    The way back to zero belongs to the last step. None: the profile has no ``motion``, or no speed for a step.
    """
    motion = profile.motion
    speeds = [_speed(step, profile) for step in job.steps]
    if motion is None or not job.steps or any(speed is None for speed in speeds):
        return None
    down, lifted = _lift_seconds(profile, motion)
    points, speed_of, step_of, stops, waits = [np.zeros((1, 2))], [], [], [], [0.0] * len(job.steps)
    for place, (step, speed) in enumerate(zip(job.steps, speeds, strict=True)):
        strokes = step.strokes * (1 if step.setting is None else step.setting.passes)
        waits[place] = len(strokes) * (down + lifted)
        for stroke in strokes:
            moves = len(stroke) - 1
            points.append(stroke + job.at)
            speed_of += [motion.travel_mm_s, *[speed] * moves]
            step_of += [place] * (1 + moves)
            stops += [down > 0, *[False] * (moves - 1), lifted > 0]
    points.append(np.zeros((1, 2)))
    times = seconds_of_moves(
        np.concatenate(points),
        np.array([*speed_of, motion.travel_mm_s], dtype=np.float64),
        np.array([*stops, True]),
        motion.acceleration_mm_s2,
        motion.corner_mm,
    )
    moving = np.bincount([*step_of, len(job.steps) - 1], weights=times, minlength=len(job.steps))
    return tuple((moving + waits).tolist())


def seconds_of_moves(points: Floats, speed: Floats, stops: Bools, acceleration: float, corner: float) -> Floats:
    """Return how long each straight move takes, ``(n,)`` seconds, from rest to rest.

    ``points``, ``(n + 1, 2)`` mm; ``speed``, ``(n,)``: the most of each move in mm/s; ``stops``, ``(n,)``: whether the
    tool stands still after it; ``acceleration`` in mm/s2; ``corner``: how far the path may stray in a corner, in mm.
    """
    along = np.diff(points, axis=0)
    length = np.hypot(*along.T)
    real = length > SHORTEST_MOVE_MM
    times = np.zeros(len(length))
    if not real.any():
        return times
    # a stop after a move that is none belongs to the move before it
    stop = np.logical_or.reduceat(stops, np.flatnonzero(real))
    along, length, most = along[real] / length[real, None], length[real], speed[real]
    limit = np.zeros(len(length) + 1)  # the squared speed at both ends of all moves
    limit[1:-1] = np.where(stop[:-1], 0.0, _corner_speeds(along, most, acceleration, corner))
    squared, gain = limit.tolist(), (2 * acceleration * length).tolist()
    for move, more in enumerate(gain):
        squared[move + 1] = min(squared[move + 1], squared[move] + more)
    for move in range(len(gain) - 1, -1, -1):
        squared[move] = min(squared[move], squared[move + 1] + gain[move])
    before, after = np.array(squared[:-1]), np.array(squared[1:])
    peak = np.minimum(most**2, (before + after) / 2 + acceleration * length)
    steady = length - (2 * peak - before - after) / (2 * acceleration)
    top = np.sqrt(peak)
    times[real] = (2 * top - np.sqrt(before) - np.sqrt(after)) / acceleration + np.maximum(steady, 0.0) / top
    return times


def _corner_speeds(along: Floats, most: Floats, acceleration: float, corner: float) -> Floats:
    """Return the squares of the speeds between moves in these directions, ``(n - 1,)``."""
    slower = np.minimum(most[:-1], most[1:]) ** 2
    # the sine of half the angle between the two moves: 1 if they go straight on, 0 if the second goes back
    half = np.sqrt(np.clip((1 + (along[:-1] * along[1:]).sum(axis=1)) / 2, 0.0, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        allowed = acceleration * corner * half / (1 - half)
    return np.asarray(np.where(half > 1 - 1e-12, slower, np.minimum(slower, allowed)))


def _speed(step: JobStep, profile: Profile) -> float | None:
    """Return how fast the strokes of a step are made."""
    if step.setting is not None:
        return step.setting.speed_mm_s
    if profile.gcode is not None and profile.format == "gcode":
        return profile.gcode.draw_mm_s
    return None if profile.motion is None else profile.motion.work_mm_s


def _lift_seconds(profile: Profile, motion: Motion) -> tuple[float, float]:
    """Return how long it takes to put the tool down, and to lift it."""
    code = profile.gcode
    if code is None or profile.format != "gcode":
        return motion.lift_s, motion.lift_s
    if code.tool == "servo":
        return code.dwell_s, code.dwell_s
    if code.tool == "z":
        height = code.pen_up - code.pen_down
        return height / code.plunge_mm_s, height / motion.travel_mm_s
    return 0.0, 0.0


def about(seconds: float) -> str:
    """Return a duration in words, as exact as it is known: "about 4 min"."""
    if seconds < 90:
        return f"about {max(5, 5 * round(seconds / 5))} s"
    minutes = round(seconds / 60)
    if minutes < 90:
        return f"about {minutes} min"
    hours, rest = divmod(5 * round(minutes / 5), 60)
    return f"about {hours} h {rest} min" if rest else f"about {hours} h"
