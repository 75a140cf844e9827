"""The data that every stage shares, and errors."""
