"""Check a site that was built: every link inside it leads somewhere, and nothing is loaded from elsewhere."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r'(?:href|src)="([^"#]*)(?:#[^"]*)?"')
LOADED = re.compile(r'<(?:script|link|img|iframe)[^>]+(?:src|href)="(https?:[^"]+)"')


def problems(site: Path) -> Iterator[str]:
    """Yield what is wrong, one line for each link."""
    for page in site.rglob("*.html"):
        if "_static" in page.relative_to(site).parts:  # templates of the theme
            continue
        text = page.read_text(encoding="utf-8")
        for link in filter(None, LINK.findall(text)):
            inside = not re.match(r"[a-z]+:", link)
            if inside and not (page.parent / unquote(link.split("?")[0])).exists():
                yield f"{page.relative_to(site)}: {link} leads nowhere"
        for link in LOADED.findall(text):
            yield f"{page.relative_to(site)}: {link} is loaded from elsewhere"


if __name__ == "__main__":
    found = sorted(set(problems(Path(sys.argv[1]))))
    print("\n".join(found))
    sys.exit(bool(found))
