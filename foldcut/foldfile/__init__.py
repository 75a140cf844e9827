"""FOLD files that are read: anybody's patterns, and foldcut's own."""
