"""The chapters; `catalogue` lists them in reading order."""
