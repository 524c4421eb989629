"""Steady sliding: closed forms, quadrature, asymptotes, and which of them to use."""
