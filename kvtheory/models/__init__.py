"""The rungs of the ladder, one room each; none imports another."""
