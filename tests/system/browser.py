"""A page of a gateway, and a real browser to look at it.

ETCM_SCREENSHOTS, where it is set, is a folder for screenshots. Every wait is for a condition.
"""
import os
import pathlib
import re
import shutil
import subprocess
import urllib.request

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from gateway_test import GatewayCase, wait_for
from programs import free_port


def open_browser(*more):
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    for argument in ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run",
                     "--disable-background-networking", "--disable-component-update",
                     "--disable-sync", "--disable-dev-shm-usage", *more]:
        options.add_argument(argument)
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


class PageCase(GatewayCase):
    HTTP = '[http]\nlisten = "127.0.0.1:0"\n'

    def start_page(self, rows, more="", **times):
        gateway = self.start_gateway(self.start_nodes(rows), self.HTTP + more, **times)
        match = gateway.wait_for_line(r"status page on (http://\S+)")
        self.url = match.group(1)
        return gateway

    def start_page_with_room(self, rows, more="", **times):
        """Has a second bus, on which nodes come when the test wants them: they join at once."""
        self.second = f"127.0.0.1:{free_port()}"
        return self.start_page(rows, f'[[bus]]\ntcp = "{self.second}"\nunits = "1"\n' + more,
                               **times)

    def join_on_second_bus(self, serial, x, y):
        self.start_nodes([f"0,{serial},join,{x},{y}"], self.second, "second")

    def get(self, path):
        with urllib.request.urlopen(self.url + path, timeout=40) as answer:
            return answer.read()


class Looking:
    """Of a case whose tests look at a page; beside the class that runs what they look at."""

    @classmethod
    def setUpClass(cls):
        cls.browser = open_browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()

    def setUp(self):
        super().setUp()
        # What the browser complained about before is not this test's.
        self.browser.get("about:blank")
        self.browser.get_log("browser")

    def size(self, width, height, colours="light"):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": colours}]})

    def forget_what_was_asked(self):
        """From now on asked() counts; a browser remembers only so many."""
        self.browser.execute_script(
            "performance.clearResourceTimings(); performance.setResourceTimingBufferSize(100000)")

    def asked(self, path):
        """How often the page has asked for that."""
        return self.browser.execute_script(
            "return performance.getEntriesByType('resource')"
            ".filter((entry) => entry.name.endsWith(arguments[0])).length", path)

    def wait_for_turns(self, count=2):
        """The page asks every second how things stand, and then for what it shows."""
        before = self.asked("/status.json")
        wait_for("other turns of the page", lambda: self.asked("/status.json") >= before + count)

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def text(self, selector):
        return self.browser.execute_script(
            "return document.querySelector(arguments[0])?.innerText ?? ''", selector)

    def wait_for_text(self, selector, pattern):
        try:
            wait_for(f"'{pattern}' in {selector}", lambda: re.search(pattern, self.text(selector)))
        except AssertionError as error:
            said = "\n".join(entry["message"] for entry in self.browser.get_log("browser"))
            raise AssertionError(f"{error}\n{self.text('body')}\n{said}") from None

    def picture(self):
        """The map's pixels, as text."""
        return self.browser.execute_script("return document.querySelector('#map').toDataURL()")

    def wait_for_another_picture(self, before):
        return wait_for("another picture of the map", lambda: self.picture() != before)

    def screenshot(self, name):
        if folder := os.environ.get("ETCM_SCREENSHOTS"):
            self.browser.save_screenshot(str(pathlib.Path(folder) / f"{name}.png"))

    def guide_picture(self, name, colours=40):
        """Pictures of the guide become part of the program, so they have few colours."""
        self.screenshot(name)
        folder = os.environ.get("ETCM_SCREENSHOTS")
        if folder and shutil.which("pngquant"):
            subprocess.run(["pngquant", "--force", "--ext", ".png", "--strip", "--nofs", "--speed", "1",
                            str(colours), str(pathlib.Path(folder) / f"{name}.png")], check=True)

    def click_at(self, across, up):
        """Clicks the map at a part of its width and height, from its middle."""
        canvas = self.find("#map")
        ActionChains(self.browser).move_to_element_with_offset(
            canvas, round(across), round(up)).click().perform()


class BrowserCase(Looking, PageCase):
    """A page of one gateway, looked at."""
