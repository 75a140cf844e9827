"""Exporters of the scored sheet as a solid."""
