"""The paper's method for several loops: rings of equal disks, joined by gates."""
