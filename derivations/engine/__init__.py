"""The engine: a step, what checks it, and what a record keeps of it."""
