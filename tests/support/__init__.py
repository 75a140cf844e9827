"""What several tests need: patterns, shapes, programs that are not ours, and where things are."""
