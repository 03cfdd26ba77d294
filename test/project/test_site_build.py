"""The site as it is built: no warning, nothing from the network, every link leads somewhere."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import pytest
from doc_text import ROOT

from tools.docs import main
from tools.workspace.layout import Layout

SITE = Layout(ROOT).site
_LINK = re.compile(r'(?:href|src)="([^"]+)"')
_OUTSIDE = re.compile(r"(https?|mailto|data):")
_LOADED = re.compile(r'<(?:script|link|img)[^>]*(?:src|href)="https?:')


@cache
def _anchors(page: Path) -> set[str]:
    return set(re.findall(r'\bid="([^"]+)"', page.read_text(encoding="utf-8")))


def _leads_somewhere(page: Path, link: str) -> bool:
    target, _, anchor = link.partition("#")
    file = (page.parent / unquote(target.partition("?")[0])).resolve() if target else page
    if not file.exists():
        return False
    return not anchor or file.suffix != ".html" or unquote(anchor) in _anchors(file)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_the_site_is_built_without_a_warning_and_its_links_hold() -> None:
    assert main() == 0
    pages = [page for page in SITE.rglob("*.html") if page.name != "search.html"]
    sources = {
        path.relative_to(ROOT / "docs").with_suffix(".html")
        for suffix in ("md", "ipynb")
        for path in (ROOT / "docs").rglob(f"*.{suffix}")
    }
    assert sources <= {page.relative_to(SITE) for page in pages}
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not _LOADED.search(text), page
        links = {link for link in _LINK.findall(text) if not _OUTSIDE.match(link)}
        assert [link for link in links if not _leads_somewhere(page, link)] == [], page
    for notebook in (ROOT / "docs" / "tutorials").glob("*.ipynb"):
        page = SITE / "tutorials" / f"{notebook.stem}.html"
        assert re.search(r"<img[^>]+_images/", page.read_text(encoding="utf-8")), page
