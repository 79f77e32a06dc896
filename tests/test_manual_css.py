"""The manual's own style, on a screen as narrow as a phone's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from markdown_pages import ROOT

from drake_viapoint.reproduction.installation import browser as chromium_path

CHROMIUM = chromium_path()
WITHOUT_A_SCREEN = ("--use-gl=angle", "--use-angle=swiftshader", "--no-sandbox")
WIDTH = 390  # [px]

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=CHROMIUM, args=[*WITHOUT_A_SCREEN])
        yield browser.new_page(viewport={"width": WIDTH, "height": 780})
        browser.close()


def show(page: Any, body: str) -> None:
    """Text in the manual's style, with the theme's largest letters."""
    style = (ROOT / "docs" / "manual.css").read_text()
    page.set_content(
        f"<style>html {{font-size: 20px}} {style}</style><div class='md-typeset'>{body}</div>"
    )


def test_an_option_is_not_broken_behind_its_dashes(page: Any) -> None:
    """Wherever in the line it comes."""
    for words in range(1, 80):
        show(page, f"<p>{'m ' * words}<code>--help</code>, and so on</p>")
        assert page.evaluate("document.querySelector('code').getClientRects().length") == 1


def test_code_longer_than_a_line_wraps(page: Any) -> None:
    show(page, f"<p>Of <code>{'words of an error ' * 10}</code></p>")
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
    assert page.evaluate("document.querySelector('code').getBoundingClientRect().height") > 40


def test_an_address_in_a_table_leaves_room_for_what_it_means(page: Any) -> None:
    address = "package://drake_viapoint/demonstrations/six_joint_serve.c3d"
    show(
        page,
        "<table><tr><th>key</th><th>default</th><th>unit</th><th>meaning</th></tr><tr>"
        f"<td><code>file</code></td><td><code>{address}</code></td><td></td>"
        "<td>A marker file: a path, or an address in the package.</td></tr></table>",
    )
    table, meaning = page.evaluate(
        "[document.querySelector('table'), document.querySelector('td:last-child')]"
        ".map(e => e.getBoundingClientRect()).map(r => [r.right, r.width])"
    )
    assert table[0] <= WIDTH
    assert meaning[1] > 60
