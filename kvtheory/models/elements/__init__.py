"""The discrete simulator: point elements that move with the base, any shape, support and drive."""
