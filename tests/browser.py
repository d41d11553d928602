"""Chromium for tests, without a window."""

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common import utils


class LocalService(Service):
    """The driver by its address: the name `localhost` has none where /etc/hosts is missing."""

    @property
    def service_url(self):
        return f"http://127.0.0.1:{self.port}"

    def is_connectable(self):
        return utils.is_connectable(self.port, "127.0.0.1")


def chromium(*arguments, logs=None):
    """A browser; `logs` are those that it keeps, as {"browser": "ALL"}."""
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    # The driver talks to the browser through a pipe, again to do without the name `localhost`.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-pipe", *arguments):
        options.add_argument(argument)
    if logs:
        options.set_capability("goog:loggingPrefs", logs)
    return webdriver.Chrome(service=LocalService("/usr/bin/chromedriver"), options=options)
