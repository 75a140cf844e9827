"""Fold a sheet so that one straight cut cuts out any drawing with straight edges."""
