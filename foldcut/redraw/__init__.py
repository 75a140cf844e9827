"""Outlines drawn anew, within a tolerance, so that they fold with few folds; docs/redraw.md has the design.

``ladder`` tries one tolerance after another and says what each costs.
"""
