"""A local web app around the command line: ``foldcut serve``."""
