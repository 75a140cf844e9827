"""The names of what can be chosen, apart from the stages so that the command line can list them without loading any."""

from __future__ import annotations

METHODS = ("auto", "mirror", "compact", "paper", "skeleton", "gate")
DEFAULT_METHOD = "auto"
"""Of "mirror", "compact" and "skeleton" the one whose pattern is easiest to fold; else "gate"."""

EFFORTS = ("fast", "normal", "best")
"""How long there is a search for the best pattern."""

ADJUST_MM = 0.25
"""How far corners may be moved so that creases meet: no more than a cut by hand is off."""

MIN_CREASE_MM = {"mirror": 0.5, "compact": 0.5, "paper": 0.0, "skeleton": 0.0, "gate": 0.0}
"""The shortest crease that a method's patterns may have unless told otherwise; some have no say in it."""
