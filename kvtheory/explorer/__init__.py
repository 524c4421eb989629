"""An interactive page of steady sliding in one HTML file."""

from kvtheory.explorer.page import explorer_page, save_explorer

__all__ = ["explorer_page", "save_explorer"]
