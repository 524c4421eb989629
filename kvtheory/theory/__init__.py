"""Functions of plain numbers and arrays that every room may use: laws of the foundation, and closed forms."""
