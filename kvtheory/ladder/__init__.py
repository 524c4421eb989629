"""The ladder: the cheapest model that is enough for what is asked of a scene."""
