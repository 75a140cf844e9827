"""The sample drawings that come with foldcut: data only."""
