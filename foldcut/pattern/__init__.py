"""Crease patterns: assembled, folded, measured."""
