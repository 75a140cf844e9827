"""What a machine does to a sheet: ``job`` makes the steps, each with its polylines, for any machine and format."""
