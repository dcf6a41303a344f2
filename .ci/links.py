"""Do the links of the built site lead somewhere? Pages, pictures and places within pages; nothing outside is asked.

`python .ci/links.py docs/_build/html`
"""

from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Page(HTMLParser):
    """Targets that a page links to, and the places that it has."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.places: set[str] = set()
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.places |= {value for key in ("id", "name") if (value := given.get(key))}
        self.links += [value for key in ("href", "src") if (value := given.get(key))]
        loads = given.get("src") or (given.get("href") if tag == "link" and given.get("rel") == "stylesheet" else None)
        self.loads += [loads] if loads and urlsplit(loads).netloc else []


def main(folder: Path) -> int:
    """Print what leads nowhere, and what asks for another host; the exit code says whether there is any."""
    pages = {path.resolve(): _Page(path) for path in sorted(folder.rglob("*.html"))}
    pages = {path: page for path, page in pages.items() if "_static" not in path.parts}
    if not pages:
        raise SystemExit(f"{folder} must hold the built site (no page is there)")
    bad, links = [], 0
    for path, page in pages.items():
        bad += [f"{path.relative_to(folder.resolve())}: loads {link} from elsewhere" for link in page.loads]
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            links += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            known = pages[target].places if target in pages else None
            if not target.exists() or (parts.fragment and known is not None and unquote(parts.fragment) not in known):
                bad.append(f"{path.relative_to(folder.resolve())}: {link}")
    print(f"{len(pages)} pages, {links} links within the site, {len(bad)} lead nowhere")
    print("\n".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
