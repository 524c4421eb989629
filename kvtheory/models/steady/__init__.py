"""Steady sliding: closed forms, quadrature, asymptotes, and the choice among them."""
