"""The pictures of the project, one script for each; `python -m figures` draws them all."""
