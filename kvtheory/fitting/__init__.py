"""Measured data: Prony series from moduli, shift factors, quantities of a scene from friction."""
