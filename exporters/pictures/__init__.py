"""Pictures to look at: panels, guides, contact sheets."""
