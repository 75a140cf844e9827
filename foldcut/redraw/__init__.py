"""Redraw an outline within a tolerance, so that it folds with few and long creases."""
