"""What tests read from a page of HTML."""

from collections.abc import Iterable
from html.parser import HTMLParser


class Page(HTMLParser):
    """What a test asks of a page: anchors, links, pictures, headings."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.addresses: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: Iterable[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if given.get("id"):
            self.ids.append(str(given["id"]))
        if tag == "a":
            self.links.append(str(given["href"]))
        if tag == "img":
            self.pictures.append(given)
        self.addresses += [str(given[name]) for name in ("src", "href") if name in given]
