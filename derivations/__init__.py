"""The paper's equations derived with SymPy, every step checked when it is made."""
