"""In what order a person folds a pattern: ``folding_steps`` makes ``FoldingStep`` after ``FoldingStep`` of it."""

from foldcut.folding_steps.groups import LEAST_GROUP, MOST_GROUPS
from foldcut.folding_steps.steps import FoldingStep, folding_steps

__all__ = ["LEAST_GROUP", "MOST_GROUPS", "FoldingStep", "folding_steps"]
