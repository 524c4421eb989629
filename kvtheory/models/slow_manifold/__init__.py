"""The slow manifold: a start from rest without inertia."""
