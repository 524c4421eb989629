"""One page of HTML to play with: sliders for a scene, and what steady sliding answers."""

from kvtheory.explorer.page import explorer_page, save_explorer

__all__ = ["explorer_page", "save_explorer"]
