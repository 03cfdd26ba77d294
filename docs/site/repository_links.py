"""Links of a page to files of the repository outside docs/ lead to pages that show these files.

So one link works in the repository's web view and on the site. A folder becomes the list of what
is in it; Markdown is shown as text with links, anything else as highlighted source.
"""

from __future__ import annotations

import html
import posixpath
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from docutils import nodes
from markdown_it import MarkdownIt
from mdit_py_plugins.anchors import anchors_plugin
from pygments.lexers.special import TextLexer

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
FOLDER = "repository"  # of these pages on the site
SCHEME = "repository:"
_LINK = re.compile(r"\]\((\.\./[^)\s]*)\)")
_NAMED_AFTER_FILE = re.compile(r"\[(\w+\.md)\](\((?!\.\./\.\.)[^)\s]*\1(?:#[^)\s]*)?\))")
_LANGUAGES = {".py": "python", ".yaml": "yaml", ".cpp": "cpp", ".hpp": "cpp", ".json": "json"}
_NOT_SHOWN = re.compile(r"__pycache__|\.egg-info|\.so$")


class Pages:
    """The files that pages link to, as pages of the site.

    Args:
        builder: of Sphinx, for the place of pages and the highlighting.
    """

    def __init__(self, builder: Any) -> None:
        self._builder = builder
        self._wanted: dict[str, Path] = {}

    def uri(self, origin: str, target: Path, anchor: str = "") -> str:
        """Link from the page `origin` to what shows a file or folder; it is written later."""
        suffix = f"#{anchor}" if anchor else ""
        if target.suffix == ".md" and target.is_relative_to(DOCS):
            name = target.relative_to(DOCS).with_suffix("").as_posix()
        else:
            name = posixpath.join(FOLDER, target.relative_to(ROOT).as_posix())
            self._wanted.setdefault(name, target)
        return str(self._builder.get_relative_uri(origin, name)) + suffix

    def rendered(self) -> Iterator[tuple[str, dict[str, str], str]]:
        """Name, context and template of every page, those that other ones ask for included."""
        done: set[str] = set()
        while left := [name for name in self._wanted if name not in done]:
            for name in left:
                done.add(name)
                title = self._wanted[name].relative_to(ROOT).as_posix()
                yield name, {"title": title, "body": self._body(name, title)}, "page.html"

    def _body(self, name: str, title: str) -> str:
        path = self._wanted[name]
        heading = f"<h1>{html.escape(title)}</h1>\n"
        if path.is_dir():
            return heading + self._listing(name, path)
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".md":
            return self._markdown(name, path, text)
        language = _LANGUAGES.get(path.suffix, "text")
        return heading + self._block(text, language)

    def _listing(self, name: str, folder: Path) -> str:
        entries = [p for p in sorted(folder.iterdir()) if not _NOT_SHOWN.search(p.name)]
        items = (
            f'<li><a href="{self.uri(name, p)}">{html.escape(p.name)}</a></li>' for p in entries
        )
        return f"<ul>{''.join(items)}</ul>"

    def _markdown(self, name: str, path: Path, text: str) -> str:
        markdown = MarkdownIt("commonmark").enable("table").use(anchors_plugin, max_level=4)
        tokens = markdown.parse(text)
        for token in tokens:
            for child in token.children or []:
                kind = {"link_open": "href", "image": "src"}.get(child.type)
                if kind:
                    child.attrSet(kind, self._moved(name, path, str(child.attrGet(kind))))
        body = str(markdown.renderer.render(tokens, markdown.options, {}))
        body = re.sub(
            r'<pre><code(?: class="language-(\w+)")?>(.*?)</code></pre>',
            lambda found: self._block(html.unescape(found[2]), found[1] or "text"),
            body,
            flags=re.DOTALL,
        )
        body = body.replace("<code>", '<code class="docutils literal notranslate">')
        return body.replace(
            "<table>", '<div class="table-wrapper"><table class="docutils">'
        ).replace("</table>", "</table></div>")

    def _block(self, text: str, language: str) -> str:
        # Forced: a file that a lexer does not like is shown all the same.
        return str(self._builder.highlighter.highlight_block(text, language, force=True))

    def _moved(self, name: str, path: Path, link: str) -> str:
        """A link of a Markdown file outside docs/, from where the site shows that file."""
        target, _, anchor = link.partition("#")
        if "://" in target or not target:
            return link
        file = (path.parent / target).resolve()
        if file.suffix in (".png", ".gif"):
            return self._picture(name, file)
        return self.uri(name, file, anchor)

    def _picture(self, name: str, file: Path) -> str:
        """Link to a copy of a picture on the site."""
        copy = posixpath.join(FOLDER, file.relative_to(ROOT).as_posix())
        target = Path(self._builder.outdir) / copy
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)
        here = posixpath.dirname(self._builder.get_target_uri(name))
        return quote(posixpath.relpath(copy, here))


def mark_links(_app: Any, docname: str, source: list[str]) -> None:
    """Links that leave docs/ get a scheme of their own, with the path from the root."""
    folder = (DOCS / docname).parent

    def marked(found: re.Match[str]) -> str:
        target, hash_, anchor = found[1].partition("#")
        path = (folder / target).resolve()
        if path.is_relative_to(DOCS):
            return found[0]
        return f"]({SCHEME}{path.relative_to(ROOT).as_posix()}{hash_}{anchor})"

    # A link whose text is a file's name gets the title of the page or section.
    source[0] = _NAMED_AFTER_FILE.sub(r"[]\2", _LINK.sub(marked, source[0]))


def _start(app: Any) -> None:
    app.ghc_pages = Pages(app.builder)


def resolve_links(app: Any, doctree: Any, docname: str) -> None:
    """Marked links lead to the pages of their files."""
    for node in doctree.findall(nodes.reference):
        uri = node.get("refuri", "")
        if uri.startswith(SCHEME):
            target, _, anchor = uri.removeprefix(SCHEME).partition("#")
            node["refuri"] = app.ghc_pages.uri(docname, ROOT / target, anchor)


def setup(app: Any) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.add_lexer("csv", TextLexer)  # Pygments has none of this name
    app.connect("builder-inited", _start)
    app.connect("source-read", mark_links)
    app.connect("doctree-resolved", resolve_links)
    app.connect("html-collect-pages", lambda app: app.ghc_pages.rendered())
    return {"parallel_read_safe": False}
