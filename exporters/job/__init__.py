"""Files of the job that a machine does."""
