"""Transient sliding on a Prony series: an equation of motion, accumulators for each arm, two edges (F23)."""
