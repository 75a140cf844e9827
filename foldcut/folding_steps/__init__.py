"""In what order a person folds a pattern: ``folding_steps`` makes ``FoldingStep`` after ``FoldingStep`` of it.

``phases`` counts them, and ``easier`` chooses mountains, valleys and layers so that they begin with simple folds.
"""

from foldcut.folding_steps.groups import LEAST_GROUP, MOST_GROUPS
from foldcut.folding_steps.phases import Phase, difficulty_of, in_words, lines_of, phases
from foldcut.folding_steps.steps import FoldingStep, folding_steps

__all__ = [
    "LEAST_GROUP",
    "MOST_GROUPS",
    "FoldingStep",
    "Phase",
    "difficulty_of",
    "folding_steps",
    "in_words",
    "lines_of",
    "phases",
]
