"""Buttons that save the pose."""

from __future__ import annotations

from typing import Any

from .dragging import Dragging
from .saving import FORMATS, saved


class SavePanel:
    """Saves the pose to a download of the browser."""

    def __init__(self, page: Dragging) -> None:
        gui = page.scene.server.gui
        with gui.add_folder("Save the pose"):
            self._kind = gui.add_button_group("", tuple(kind.upper() for kind in FORMATS))

        @self._kind.on_click
        def _(event: Any) -> None:
            kind = str(self._kind.value).lower()
            data = page.call(lambda: saved(page.body, kind))
            to = event.client or page.scene.server
            to.send_file_download(f"{page.body.name}.{kind}", data, save_immediately=True)
