"""What a machine does with a pattern: operations, each with its polylines."""
