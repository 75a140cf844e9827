"""The simple and slow twins of fast code, to compare with."""
