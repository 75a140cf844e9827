"""Hostile and odd files, and what has to become of each."""
