"""Units of length: how many millimetres each is, as sheets and files name them.

1 in = 25.4 mm exactly (International Yard and Pound, 1959); px, pt and pc are those of CSS Values 3, section
6.2: 96, 72 and 6 to the inch.
"""

MM_PER_INCH = 25.4

#: Millimetres per unit.
MM_PER_UNIT = {
    "mm": 1.0,
    "cm": 10.0,
    "in": MM_PER_INCH,
    "px": MM_PER_INCH / 96,
    "pt": MM_PER_INCH / 72,
    "pc": MM_PER_INCH / 6,
}
