"""A second opinion on the derivations: their claims are checked again from `derivations.json` alone.

Nothing here is shared with the engine that proved them, and SymPy is not needed: exact rational numbers and
balls of python-flint at random points of the domain, derivatives and signs by programs of its own.
"""
