"""Code blocks of the README and of the documentation pages run, and print the output shown."""

import contextlib
import io
import os
import re
import shlex
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ["docs", "docs/guide", "docs/reference"]
PAGES = ["README.md", "python/README.md", *sorted(f"{folder}/{page.name}" for folder in FOLDERS for page in (ROOT / folder).glob("*.md"))]


def blocks_of(page):
    """Python blocks of a page, each with the output that the page shows for it, or None."""
    text = (ROOT / page).read_text()
    blocks = list(re.finditer(r"(?<!-->\n)^```python\n(.*?)^```", text, re.S | re.M))
    ends = [block.start() for block in blocks[1:]] + [len(text)]
    for block, end in zip(blocks, ends):
        output = re.search(r"^Output in Python:\n\n```text\n(.*?)^```", text[block.end() : end], re.S | re.M)
        yield block[1], output and output[1]


def without_counts(output):
    """Output without numbers of iterations, which depend on the processor."""
    return re.sub(r"\d+ (iteration|attempt)s?", r"N \1s", output).strip()


@pytest.mark.parametrize("page", [page for page in PAGES if any(blocks_of(page))])
def test_page_code_runs_and_prints_its_output(monkeypatch, page):
    monkeypatch.chdir(ROOT)
    names = {}
    for block, output in blocks_of(page):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, page, "exec"), names)  # noqa: S102
        if output is not None:
            assert without_counts(printed.getvalue()) == without_counts(output)


OPENERS = [
    pytest.param(language, block, id=f"{page}-{number}")
    for page in PAGES[1:]  # The README's opens the web page, which `web/site/tests` opens.
    for number, (language, block) in enumerate(
        re.findall(r"^<!-- until its page answers -->\n```(sh|python)\n(.*?)^```", (ROOT / page).read_text(), re.S | re.M)
    )
]


def a_free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.mark.parametrize("language, block", OPENERS)
def test_viewer_commands_open_a_page(language, block):
    pytest.importorskip("viser", reason="SKIPPED LOUDLY: viser is not installed: pip install 'kinopt[view]'")
    if language == "sh":
        (line,) = [line for line in block.splitlines() if not line.startswith("pip install")]
        words = shlex.split(line)
        assert words[:3] == ["python", "-m", "kinopt.view"]
        command = [sys.executable, *words[1:], "--no-browser", "--port", str(a_free_port())]
    else:
        command = [sys.executable, "-c", block]
    environment = {**os.environ, "BROWSER": "true"}
    with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            lines = (line for line in process.stdout if "http://" in line)
            url = re.search(r"http://\S+", next(lines))
            assert url is not None
            with urllib.request.urlopen(url[0], timeout=120) as page:
                assert page.status == 200
        finally:
            process.kill()


def test_some_pages_have_viewer_commands():
    assert len(OPENERS) >= 4


def test_pages_have_blocks_and_outputs():
    assert sum(any(blocks_of(page)) for page in PAGES) >= 25
    assert sum(output is not None for page in PAGES for _, output in blocks_of(page)) >= 40
