"""Functions of plain numbers and arrays that every room may use, written by `derivations` from its proofs."""
