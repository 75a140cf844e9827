"""Points, polygons and graphs in the plane: knows nothing of files, of machines, or of how patterns are found."""
