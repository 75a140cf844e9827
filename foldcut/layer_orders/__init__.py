"""Layer orders of any pattern that folds flat: found, counted, or shown to be impossible."""
