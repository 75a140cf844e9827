"""Points, polygons and graphs in the plane: knows nothing of paper."""
