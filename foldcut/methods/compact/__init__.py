"""One loop, few creases: a search over walks along the boundary."""
