"""From a drawing to a valid shape on its sheet.

In the order in which they are used: ``limits`` (refuse what is too large), ``mend`` (repair, and reduce on request),
``shape`` (the valid shape, or an error), ``simplify`` (leave out corners), ``placement`` (lay the shape on the sheet).
"""
