"""Any loops, few creases: along the straight skeleton (Demaine, Demaine and Lubiw)."""
