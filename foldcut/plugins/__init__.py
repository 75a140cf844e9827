"""How other programs call foldcut: an extension for Inkscape, a command for vpype. Both only pass things on."""
