"""Comparison of methods: cost and accuracy, stability, and failures."""
