"""The page in a real browser, where one is installed."""

import base64
import itertools
import json
import shutil
import subprocess
import time
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from polyfold.viz._report import write_report

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

OPTIONS = [
    f"--{option}"
    for option in (
        "headless=new",
        "no-sandbox",
        "disable-gpu",
        "disable-quic",
        "no-first-run",
        "disable-background-networking",
        "disable-component-update",
        "disable-sync",
        "disable-dev-shm-usage",
        "remote-debugging-port=0",
    )
]


class Tab:
    """A tab of a running browser, by its debugging protocol."""

    def __init__(self, address):
        websocket = pytest.importorskip("websocket", reason="needs websocket-client, which JupyterLab brings")
        self._socket = websocket.create_connection(address, timeout=30, suppress_origin=True)
        self._numbers = itertools.count(1)
        self.events = []

    def call(self, method, **parameters):
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while (message := json.loads(self._socket.recv())).get("id") != number:
            self.events.append(message)
        assert "error" not in message, message
        return message["result"]

    def value(self, expression):
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def picture(self):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        return np.asarray(Image.open(BytesIO(base64.b64decode(data))).convert("RGB")).astype(int)

    def complaints(self):
        """What the console, scripts, the security policy or the network complained about."""
        kinds = ("Log.entryAdded", "Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Network.loadingFailed")
        return [event for event in self.events if event.get("method") in kinds]

    def requests(self):
        return [e["params"]["request"]["url"] for e in self.events if e.get("method") == "Network.requestWillBeSent"]

    def close(self):
        self._socket.close()


@pytest.fixture
def tab(tmp_path):
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    from urllib.request import urlopen

    profile = tmp_path / "profile"
    with (tmp_path / "browser.log").open("w") as log:
        browser = subprocess.Popen(
            [CHROMIUM, *OPTIONS, f"--user-data-dir={profile}", "about:blank"], stdout=log, stderr=log
        )
    try:
        deadline = time.monotonic() + 60
        port_file = profile / "DevToolsActivePort"
        while not (port_file.exists() and "\n" in port_file.read_text()):
            if browser.poll() is not None or time.monotonic() > deadline:
                pytest.skip("chromium is installed but does not start here")
            time.sleep(0.05)
        port = port_file.read_text().split("\n")[0]
        with urlopen(f"http://127.0.0.1:{port}/json") as answer:
            pages = [found for found in json.load(answer) if found["type"] == "page"]
        found = Tab(pages[0]["webSocketDebuggerUrl"])
        for domain in ("Page", "Runtime", "Log", "Network"):
            found.call(f"{domain}.enable")
        yield found
        found.close()
    finally:
        browser.kill()
        browser.wait()


SHOWN = "document.querySelectorAll('.card:not([hidden])').length"


def choose(tab, name, value):
    tab.value(
        f"(() => {{ const field = document.querySelector('select[name={name}]'); field.value = '{value}';"
        " field.dispatchEvent(new Event('change', {bubbles: true})); })()"
    )


def test_the_page_works_from_the_file_system(full_run, tab):
    path = write_report(full_run)
    tab.call("Emulation.setDeviceMetricsOverride", width=1200, height=900, deviceScaleFactor=1, mobile=False)
    tab.call("Page.navigate", url=path.as_uri())
    tab.value(
        "new Promise(done => document.readyState === 'complete' ? done() : addEventListener('load', () => done()))"
    )

    everything = tab.value("document.querySelectorAll('.card').length")
    highlights = tab.value(SHOWN)
    assert everything == 12
    assert 0 < highlights < everything, "highlights are shown at first"
    choose(tab, "pick", "")
    assert tab.value(SHOWN) == everything
    choose(tab, "variant", "theirs")
    assert tab.value(SHOWN) == 6
    choose(tab, "kind", "tshirt")
    assert tab.value(SHOWN) == 2
    assert tab.value("document.getElementById('count').textContent") == "2 of 12 shown"
    choose(tab, "success", "yes")
    assert tab.value(SHOWN) == 0
    assert tab.value("document.getElementById('none').hidden") is False
    tab.value("document.querySelector('#filters button').click()")
    assert tab.value("new Promise(done => setTimeout(() => done(" + SHOWN + "), 50))") == highlights
    assert tab.value("[...document.images].every(image => image.loading === 'lazy')")

    looks = {}
    for scheme, width in (("light", 1200), ("dark", 1200), ("light", 400)):
        tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        tab.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        looks[scheme, width] = tab.picture()
        assert looks[scheme, width].std() > 5, "something is drawn"
        assert tab.value("document.documentElement.scrollWidth") <= width, "no sideways scrolling of the page"
    assert looks["light", 1200].mean() > 200
    assert looks["dark", 1200].mean() < 80
    assert tab.complaints() == []
    assert all(url.startswith(("file:", "data:")) for url in tab.requests())
