"""Coverage-guided fuzzing of the readers: ``python tests/fuzz/run.py READER --seconds 300``."""
