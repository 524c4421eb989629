"""Any time series compared with theory: reading it, error budget, checks, diagnosis."""
