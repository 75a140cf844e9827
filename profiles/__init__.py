"""Device and layout profiles: one TOML file each; data only."""
