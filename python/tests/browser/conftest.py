"""A headless browser for the tests of the viewer's pages."""

from __future__ import annotations

import os
import shutil
import warnings
from dataclasses import dataclass, field

import numpy as np
import pytest

from waiting import wait_until

MISSING = (
    "SKIPPED: THE BROWSER TESTS OF THE VIEWER DID NOT RUN: {}. They need viser and playwright "
    "(pip install 'kinopt[view,browser]') and Chromium (apt-get install chromium, or KINOPT_CHROMIUM=its path)"
)
#: Chromium renders in software and accesses no network.
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
#: Console messages of viser's page at its start.
STARTING = (
    "Detected ",
    "WebGL support:",
    "Connecting to:",
    "Connected! ",
    "Tried to send ViewerCameraMessage but websocket is not connected!",
    "THREE.Clock: This module has been deprecated",
    # From software rendering and from reading pictures back.
    "[Performance] Setting DPR",
)


def left_out(why: str) -> None:
    """Reports that these tests do not run."""
    text = MISSING.format(why)
    warnings.warn(text, stacklevel=2)
    pytest.skip(text)


@pytest.fixture(scope="session")
def chromium():
    """A Chromium, controlled by Playwright."""
    try:
        import viser  # noqa: F401
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        left_out(f"there is no {error.name}")
    found = os.environ.get("KINOPT_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    if not found:
        left_out("there is no Chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=FLAGS)
        yield browser
        browser.close()


@dataclass
class Tab:
    """A page of the viewer in the browser, with its messages and received data."""

    tab: object
    page: object
    console: list = field(default_factory=list)
    #: Size of each message that the page received, bytes.
    received: list = field(default_factory=list)

    @property
    def client(self):
        """The client of viser for this tab."""
        (client,) = self.page.scene.server.get_clients().values()
        return client

    def pixel(self, position):
        """Pixel of a position of the model on the page, from the upper left corner, shape (2,)."""
        camera = self.client.camera
        w, x, y, z = camera.wxyz
        turned = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        # viser's cameras look along +z, with y down.
        ahead = turned.T @ (np.asarray(position) * self.page.scene.drawn - camera.position)
        canvas = self.tab.locator("canvas").first.bounding_box()
        focal = canvas["height"] / 2 / np.tan(camera.fov / 2)
        middle = np.array([canvas["x"] + canvas["width"] / 2, canvas["y"] + canvas["height"] / 2])
        return middle + focal * ahead[:2] / ahead[2]

    def colors(self):
        """Picture of the page, shape (height, width, 3)."""
        import io

        from PIL import Image

        return np.asarray(
            Image.open(io.BytesIO(self.tab.screenshot(scale="css"))).convert("RGB"), dtype=int
        )

    def settle(self, seconds=0.6):
        """Waits for the browser to draw what it received."""
        self.tab.wait_for_timeout(1000 * seconds)

    def until(self, holds, seconds=120.0):
        """Waits until `holds()` while the browser runs; the caller then asserts it."""
        wait_until(holds, pause=lambda: self.settle(0.1), seconds=seconds)

    def hear_all(self):
        """Waits until the server sends nothing more."""
        received_count = -1
        while received_count != len(self.received):
            received_count = len(self.received)
            self.settle(1.5)

    def status(self):
        """Status on the page, as text."""
        return self.tab.locator(".kinopt-status").inner_text()

    def come_to_rest(self, looks=5):
        """Waits until several successive looks find no motion and an up-to-date page."""
        before, same = None, 0

        def rests():
            nonlocal before, same
            # Read from the page first, which has then sent all mouse events.
            status = self.status()
            page = self.page
            now = [target.placement.tobytes() for target in page.targets.values()]
            idle = not page.scene.loop._tickers and status.split() == page.status.text.split()
            same = same + 1 if idle and now == before else 0
            before = now
            return same >= looks

        self.until(rests)

    def dismiss_notes(self):
        """Closes the browser's notes about software rendering."""
        for close in self.tab.locator(".mantine-Notification-closeButton").all():
            close.click()
        self.settle(0.5)


@pytest.fixture
def open_tab(chromium):
    """Opens a page of the viewer in the browser: `open_tab(page)`, at low resolution unless `sharp`."""
    opened = []

    def open_one(page, width=820, height=480, sharp=False):
        # The time of software rendering depends on the number of pixels.
        scale = 1.0 if sharp else 0.5
        tab = chromium.new_page(viewport={"width": width, "height": height}, device_scale_factor=scale)
        # Long, for machines with other load.
        tab.set_default_timeout(120_000)
        shown = Tab(tab, page)
        opened.append(shown)
        tab.on("console", lambda message: shown.console.append(f"{message.type}: {message.text}"))
        tab.on("pageerror", lambda error: shown.console.append(f"error: {error}"))
        tab.on("requestfailed", lambda request: shown.console.append(f"failed: {request.url}"))
        tab.on(
            "websocket",
            lambda socket: socket.on("framereceived", lambda data: shown.received.append(len(data))),
        )
        tab.goto(page.scene.url)
        tab.wait_for_selector("canvas")
        tab.wait_for_selector(".kinopt-status")
        shown.until(page.scene.server.get_clients)
        shown.hear_all()
        shown.dismiss_notes()
        return shown

    yield open_one
    for shown in opened:
        shown.tab.close()


def unexpected(console):
    """Console messages other than those of viser's start."""
    lines = (line for line in console if not line.split(": ", 1)[1].startswith(STARTING))
    return [line for line in lines if "GPU stall due to ReadPixels" not in line]
