"""Recordings of clips: a page without a server, or a video."""

from __future__ import annotations

import io
from functools import partial
from typing import Any

import numpy as np
import viser

import kinopt

from .body import Clip
from .canvas import Canvas

#: Formats of videos, which a connected browser renders.
VIDEO_FORMATS = ("gif", "mp4")
#: Frames per second: GIF files have times of whole hundredths of a second.
FPS = 25


def recorded(
    scene: Canvas,
    clip: Clip,
    kind: str,
    *,
    speed: float = 1.0,
    size: tuple[int, int] = (960, 540),
    client: viser.ClientHandle | None = None,
) -> bytes:
    """A clip as a file of this kind: "html", "gif" or "mp4"; `size` is width and height of a video, even
    numbers of pixels.

    Raises `InvalidValueError` for another kind, and for a video without a browser that shows the page. Raises
    `ImportError` for "mp4" without imageio-ffmpeg.
    """
    if kind not in ("html", *VIDEO_FORMATS):
        raise kinopt.InvalidValueError(f"recording `{kind}`: expected html, {', '.join(VIDEO_FORMATS)}")
    start, end = clip.span
    times = np.arange(start, end + 1e-9, speed / FPS).tolist()

    def show(seconds: float) -> None:
        scene.loop.call(partial(clip.show, seconds))

    if kind == "html":
        show(start)
        serializer = scene.server.get_scene_serializer()
        for seconds in times:
            show(seconds)
            serializer.insert_sleep(1.0 / FPS)
        return serializer.as_html().encode()
    viewers = list(scene.server.get_clients().values())
    if client is None and not viewers:
        raise kinopt.InvalidValueError(f"a browser renders the frames of a {kind}: open {scene.url} first")
    viewer: Any = client or viewers[0]
    with io.BytesIO() as file:
        with _writer(file, kind) as writer:
            for seconds in times:
                show(seconds)
                writer.append_data(viewer.get_render(size[1], size[0]))
        return file.getvalue()


def _writer(file: io.BytesIO, kind: str) -> Any:
    import imageio

    if kind == "gif":
        return imageio.get_writer(file, format="GIF", mode="I", duration=1000.0 / FPS, loop=0)
    try:
        import imageio_ffmpeg  # noqa: F401
    except ImportError:
        raise ImportError("mp4 files need imageio-ffmpeg: pip install 'kinopt[video]'") from None
    return imageio.get_writer(file, format="mp4", mode="I", fps=FPS, macro_block_size=2)
