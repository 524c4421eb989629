"""Methods judged by what they cost and achieve, by where they are stable, and by how they fail."""
