"""The paper's method: disk packing (Bern, Demaine, Eppstein and Hayes)."""
