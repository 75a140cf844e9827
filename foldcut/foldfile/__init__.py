"""Reading FOLD files: any crease pattern (``read``), and finished patterns that foldcut wrote (``reopen``)."""
