"""Redraw an outline within a tolerance so that it folds with few folds: drawing -> outlines (``Shape``) for the methods."""
