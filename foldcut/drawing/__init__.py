"""A drawing becomes a shape on its sheet."""
