"""A ball by strips along the sliding direction, whose edges are in closed form."""
