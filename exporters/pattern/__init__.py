"""Files of the pattern itself."""
