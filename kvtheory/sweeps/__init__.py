"""Parameter sweeps: their plan, blocks, execution, and files."""
