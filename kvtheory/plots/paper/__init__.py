"""The figures of the paper, for any scene: a module each, with `compute` and `draw`."""
