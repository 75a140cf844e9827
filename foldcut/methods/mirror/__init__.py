"""Drawings with mirror axes: the sheet is folded along these first."""
