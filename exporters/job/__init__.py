"""Exporters of jobs: what a machine does to the sheet."""
