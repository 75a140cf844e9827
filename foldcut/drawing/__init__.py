"""From a drawing to a valid shape on its sheet.

In the order in which they are used: ``limits`` (refuse what is too large), ``mend`` (repair, and reduce on request),
``shape`` (make the valid shape, or say what is wrong), ``placement`` (sheets, and a shape on one), ``simplify`` (leave
out corners), ``laying`` (do the last two, again at each angle that a method asks for).
"""
