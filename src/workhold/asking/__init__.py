"""The questions that the program answers: each field of each declared once, in modules that import nothing heavy."""
