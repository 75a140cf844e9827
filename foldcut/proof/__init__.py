"""Verification: what is wrong with a folded pattern, whatever made it."""
