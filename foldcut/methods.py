"""The names of what can be chosen, apart from the stages so that the command line can list them without loading any."""

from __future__ import annotations

METHODS = ("auto", "mirror", "compact", "paper", "gate")
DEFAULT_METHOD = "auto"
"""Of "mirror" and "compact" the one whose pattern is easiest to fold; "gate" where neither folds several loops."""

EFFORTS = ("fast", "normal", "best")
"""How long there is a search for the best pattern."""

MIN_CREASE_MM = {"mirror": 0.5, "compact": 0.5, "paper": 0.0, "gate": 0.0}
"""The shortest crease that a method's patterns may have unless told otherwise; disk packings have tiny ones."""
