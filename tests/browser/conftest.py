"""A Chromium without a window, whose pages are offline, and must neither ask for anything nor complain."""

import os

import pages
import pytest

from ospace.exceptions import OspaceError
from ospace.visual import browser

WANTED = "OSPACE_REQUIRE_BROWSER"


@pytest.fixture(scope="session")
def chromium():
    """Return the path of Chromium; without one, tests fail where `WANTED` is set, and are skipped elsewhere."""
    try:
        return browser.find()
    except OspaceError as error:
        (pytest.fail if os.environ.get(WANTED) else pytest.skip)(str(error))


@pytest.fixture(scope="session")
def launched(chromium):
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        (pytest.fail if os.environ.get(WANTED) else pytest.skip)(f"playwright is not installed: {error}")
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium, args=browser.flags())
        yield opened
        opened.close()


@pytest.fixture
def open_page(launched, tmp_path):
    """Return what opens pages of this test; each is judged when the test ends."""
    opened = []

    def call(source, size=(320, 240), **options):
        opened.append(pages.Opened(launched, source, tmp_path / f"page {len(opened)}.html", size, **options))
        return opened[-1]

    yield call
    try:
        for one in opened:
            one.judge()
    finally:
        for one in opened:
            one.close()
