"""The names of what can be chosen, apart from the stages so that the command line can list them without loading any."""

from __future__ import annotations

METHODS = ("compact", "paper")
DEFAULT_METHOD = "compact"

EFFORTS = ("fast", "normal", "best")
"""How long the compact method searches."""

MIN_CREASE_MM = {"compact": 0.5, "paper": 0.0}
"""The shortest crease that a method's patterns may have unless told otherwise; the paper's are tiny by nature."""
