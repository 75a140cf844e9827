"""Redraw an outline within a tolerance so that it folds with few folds: a drawing -> outlines for the methods."""
