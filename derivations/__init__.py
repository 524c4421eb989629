"""The paper's equations derived with SymPy, every step checked when it is made."""

import os

os.environ.setdefault("SYMPY_CACHE_SIZE", "100000")  # SymPy's own 1000 forget within a chapter
