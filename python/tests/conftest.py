"""Tests open no browser windows."""

import webbrowser

import pytest


@pytest.fixture(autouse=True)
def opened_addresses(monkeypatch):
    """Addresses that a test opens in a browser."""
    addresses = []
    monkeypatch.setattr(webbrowser, "open", addresses.append)
    return addresses
