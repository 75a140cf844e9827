"""Exporters of the crease pattern itself."""
