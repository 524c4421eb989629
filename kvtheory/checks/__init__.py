"""Any time series held against theory: reading it, what may differ and why, checks, diagnosis."""
