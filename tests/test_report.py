"""The page and a recording of a real run, in a real browser: alone, from a disk and a server."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from progress_bars import Bars

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction.experiments import EXPERIMENTS
from drake_viapoint.reproduction.installation import browser as chromium_path
from drake_viapoint.reproduction.ledger import Ledger
from drake_viapoint.reproduction.report import PAGE, report, write_report
from drake_viapoint.reproduction.reproduce import reproduce

CHROMIUM = chromium_path()
WITHOUT_A_SCREEN = (
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # it is not to look for news of itself
    "--disable-background-networking",
    "--disable-component-update",
    "--no-sandbox",
)
PATIENCE = 120_000  # [ms]: machines are busy, and pixels are drawn by the processor
SIZES = {"wide": (1200, 900), "phone": (390, 780)}

in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium")


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of results with one experiment made, seven not yet."""
    path = tmp_path_factory.mktemp("page") / "results"
    reproduce(path, {"upswing": 1}, Bars())
    return path


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=CHROMIUM, args=[*WITHOUT_A_SCREEN])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def server(out: Path) -> Iterator[str]:
    """Address of a web server of the folder."""

    class Silent(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Silent, directory=str(out))) as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{serving.server_port}"
        serving.shutdown()


class Watched:
    """A page that remembers what it asked for and complained of."""

    def __init__(self, browser: Any, size: str) -> None:
        width, height = SIZES[size]
        self.page = browser.new_page(viewport={"width": width, "height": height})
        self.page.set_default_timeout(PATIENCE)
        self.asked: list[str] = []
        self.complaints: list[str] = []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("requestfailed", lambda request: self.complaints.append(request.url))
        self.page.on("console", self._hear)

    def _hear(self, message: Any) -> None:
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.complaints.append(message.text)

    def check_alone(self) -> None:
        """Nothing left the machine, and nothing went wrong."""
        assert self.asked
        for address in self.asked:
            parts = urlsplit(address)
            assert parts.scheme in ("file", "data", "blob") or parts.hostname == "127.0.0.1"
        assert self.complaints == []


@in_a_browser
@pytest.mark.parametrize(("where", "size"), [("disk", "wide"), ("server", "phone")])
def test_the_page_in_a_browser(
    chromium: Any, out: Path, server: str, where: str, size: str
) -> None:
    watched = Watched(chromium, size)
    page = watched.page
    page.goto(f"{server}/{PAGE}" if where == "server" else (out / PAGE).as_uri())
    pictures = page.locator("figure img")
    assert pictures.count() == 4
    for number in range(4):
        picture = pictures.nth(number)
        picture.scroll_into_view_if_needed()
        assert picture.is_visible()
        assert picture.evaluate("image => image.complete && image.naturalWidth > 300")
        box = picture.bounding_box()
        assert 200 < box["width"] <= SIZES[size][0]
        assert len(picture.get_attribute("alt")) > 40
    assert page.locator("iframe").count() == 3
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    verdicts = page.locator(".verdict")
    assert verdicts.first.is_visible()
    watched.check_alone()
    page.close()


@in_a_browser
def test_recordings_play_in_the_page(chromium: Any, out: Path) -> None:
    watched = Watched(chromium, "wide")
    page = watched.page
    page.goto((out / PAGE).as_uri())
    frame = page.locator("iframe").first
    frame.scroll_into_view_if_needed()
    canvas = page.frame_locator("iframe").first.locator("canvas").first
    canvas.wait_for(state="visible")
    assert changes(canvas)
    watched.check_alone()
    page.close()


@in_a_browser
@pytest.mark.parametrize(
    ("where", "trial"), [("disk", 1), ("disk", 15), ("disk", 30), ("server", 30)]
)
def test_a_recording_plays_alone(
    chromium: Any, out: Path, server: str, where: str, trial: int
) -> None:
    watched = Watched(chromium, "phone")
    name = f"upswing_trial{trial:02d}.html"
    watched.page.goto(f"{server}/{name}" if where == "server" else (out / name).as_uri())
    canvas = watched.page.locator("canvas").first
    canvas.wait_for(state="visible")
    assert changes(canvas)
    watched.check_alone()
    watched.page.close()


def changes(canvas: Any) -> bool:
    """Whether a canvas shows something else some time later."""
    before = canvas.screenshot()
    for _ in range(PATIENCE // 250):
        canvas.page.wait_for_timeout(250)
        if canvas.screenshot() != before:
            return True
    return False


@in_a_browser
def test_the_page_in_print(chromium: Any, out: Path) -> None:
    watched = Watched(chromium, "wide")
    page = watched.page
    page.goto((out / PAGE).as_uri())
    page.emulate_media(media="print")
    assert page.locator("figure img").first.is_visible()
    assert not page.locator("iframe").first.is_visible(), "paper does not play"
    assert not page.locator("nav").is_visible()
    assert page.pdf(format="A4", print_background=True).startswith(b"%PDF")
    page.close()


# ----------------------------------------------------------------------------- without a browser


class Parts(HTMLParser):
    """What a page links to, shows, and names."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.names: list[str] = []
        self.without_alt: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.links += [given[key] for key in ("href", "src") if key in given]
        self.names += [given["id"]] if "id" in given else []
        if (tag == "img" and not given.get("alt")) or (tag == "iframe" and not given.get("title")):
            self.without_alt.append(given.get("src", "?"))


def parts_of(out: Path) -> Parts:
    parts = Parts()
    parts.feed((out / PAGE).read_text(encoding="utf-8"))
    return parts


def test_no_link_of_the_page_is_broken(out: Path) -> None:
    parts = parts_of(out)
    assert parts.without_alt == []
    assert len(parts.names) == len(set(parts.names))
    for link in parts.links:
        if link.startswith("#"):
            assert link[1:] in parts.names
        elif not link.startswith("data:"):
            assert (out / link).is_file(), link


def test_the_page_says_how_to_make_what_is_not_there_yet(out: Path) -> None:
    text = (out / PAGE).read_text(encoding="utf-8")
    assert text.count("Not made in this folder yet.") == len(EXPERIMENTS) - 1
    for experiment in EXPERIMENTS:
        assert f"--only {experiment.name}" in text
    assert re.search(r"drake 1\.\d+", text)
    assert "seed: 0" in text
    assert str(out) not in re.sub(r"<pre>.*?</pre>", "", text), "it can be moved elsewhere"


def test_the_page_shows_every_verdict(out: Path) -> None:
    entry = Ledger(out).read("upswing")
    assert entry is not None
    assert entry.findings is not None
    text = (out / PAGE).read_text(encoding="utf-8")
    for row in entry.findings.comparisons:
        assert row.quantity in text
    assert text.count('class="verdict ') == len(entry.findings.comparisons)


def test_words_of_a_run_do_no_harm(out: Path) -> None:
    entry = Ledger(out).read("upswing")
    assert entry is not None
    assert entry.findings is not None
    evil = "<script>alert('a & b')</script>"
    findings = type(entry.findings)((evil,))
    text = report(out, {"upswing": type(entry)(entry.depends, 1, "", "", 0.0, findings)})
    assert "<script" not in text
    assert "&lt;script&gt;" in text


def test_an_empty_folder_has_a_page(tmp_path: Path) -> None:
    page = write_report(tmp_path / "new", {})
    assert page.read_text(encoding="utf-8").count("Not made") == len(EXPERIMENTS)


def test_a_page_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ViapointError, match="cannot be written"):
        write_report(tmp_path / "file", {})
