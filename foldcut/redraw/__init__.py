"""Draw an outline anew, within a tolerance, so that it folds with few folds."""
