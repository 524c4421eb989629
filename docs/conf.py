"""Settings of the site. What follows from the code is written to `generated/` before Sphinx reads it."""

import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path[:0] = [str(HERE), str(ROOT)]
os.environ["PYTHONPATH"] = str(ROOT)  # of the kernels that run the notebooks
os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")

from generators import gallery, mathml, write_all  # noqa: E402

import kvtheory  # noqa: E402

project = "kvtheory"
author = "The kvtheory developers"
project_copyright = "2026, the kvtheory developers"
version = release = kvtheory.__version__

extensions = ["myst_nb", "sphinx_gallery.gen_gallery"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb", ".rst": "restructuredtext"}
exclude_patterns = [
    "_build",
    "generated/scripts",
    "generated/exercises",
    "generated/folders/*/*.md",
    "generated/gallery/**/*.ipynb",
    "generated/gallery/**/*.py",
]
suppress_warnings = ["config.cache", "myst.header"]
nitpicky = False

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
myst_dmath_double_inline = True
nb_execution_mode = "auto"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_execution_show_tb = True

html_theme = "pydata_sphinx_theme"
html_title = "kvtheory"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = ["generated/extra"]
html_theme_options = {
    "navigation_with_keys": True,
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_context = {"default_mode": "auto"}
html_sidebars = {"index": []}
html_show_sourcelink = False
html_math_renderer = "mathml"

sphinx_gallery_conf = {
    "examples_dirs": "generated/scripts",
    "gallery_dirs": "generated/gallery",
    "filename_pattern": "/",
    "image_scrapers": (gallery.pictures,),
    "reset_modules": (),
    "within_subsection_order": "generators.gallery.order",
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
    "min_reported_time": float("inf"),  # the pictures are there already
    "remove_config_comments": True,
}


def setup(app):
    """Let formulas be MathML, which needs no script, and write the pages that follow from the code."""
    write_all(HERE / "generated")
    gallery.patch(HERE / "generated")
    mathml.register(app)
