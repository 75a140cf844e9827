"""The files of a finished pattern: their bytes, and how they are written."""
