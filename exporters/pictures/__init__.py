"""Pictures to look at: of patterns, of the disk method's construction, folding guides, and contact sheets."""
