"""The scored sheet as a solid."""
