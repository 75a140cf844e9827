"""The files of a finished pattern: ``render`` makes their bytes, ``atomic`` writes them."""
