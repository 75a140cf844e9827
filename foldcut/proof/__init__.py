"""The proof that a pattern folds flat and that one cut cuts out the shape, from the pattern alone.

``verify`` runs all checks; each of the other modules makes one kind. Nothing here sees how a pattern was made.
"""
