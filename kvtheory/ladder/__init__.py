"""The ladder: the cheapest model that meets the requested tolerance for a scene."""
