"""Where the meshes that a robot's file names are, if they are at hand."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from urllib.parse import unquote, urlparse

from .solids import Solid

#: Environment variables whose folders hold ROS packages.
PACKAGE_PATHS = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH")


class MeshFiles:
    """Finds and reads mesh files: STL, OBJ, PLY, glTF, and COLLADA where pycollada is installed."""

    def __init__(
        self, beside: Path | None = None, packages: Mapping[str, str | Path] | Iterable[str | Path] = ()
    ) -> None:
        """`beside` is the robot's own folder; `packages` folders of packages by name, or folders that hold them."""
        self._beside = beside
        self._named: dict[str, Path] = {}
        self._folders: list[Path] = []
        if isinstance(packages, Mapping):
            self._named = {name: Path(folder) for name, folder in packages.items()}
        else:
            self._folders = [Path(folder) for folder in packages]
        #: What could not be drawn, one line each.
        self.missing: list[str] = []

    def find(self, file: str) -> Path | None:
        """The path of a mesh named `package://…`, `file://…`, or by a path; None where it is not at hand."""
        return next((place for place in self._places(file) if place.is_file()), None)

    def _places(self, file: str) -> Iterable[Path]:
        url = urlparse(file)
        if url.scheme == "package":
            package, inside = url.netloc, unquote(url.path).lstrip("/")
            if package in self._named:
                yield self._named[package] / inside
            for folder in self._package_folders():
                yield folder / package / inside
                yield folder / "share" / package / inside
                if folder.name == package:
                    yield folder / inside
            return
        path = Path(unquote(url.path)) if url.scheme == "file" else Path(file)
        if self._beside is not None and not path.is_absolute():
            yield self._beside / path
        yield path

    def _package_folders(self) -> Iterable[Path]:
        yield from self._folders
        if self._beside is not None:
            # A robot's file usually lies within the package that its meshes are in.
            yield self._beside
            yield from self._beside.parents
        for variable in PACKAGE_PATHS:
            yield from (Path(folder) for folder in os.environ.get(variable, "").split(os.pathsep) if folder)

    def read(self, file: str) -> list[tuple[Solid, tuple[int, int, int] | None]] | None:
        """The pieces of a mesh with their colours; None, and a line in `missing`, where there is none to draw."""
        import numpy as np
        import trimesh

        path = self.find(file)
        if path is None:
            self.missing.append(f"{file}: not at hand")
            return None
        try:
            loaded = trimesh.load_scene(path)
        except Exception as error:  # noqa: BLE001 - readers of many formats raise what they like
            self.missing.append(f"{path}: {_one_line(error)}")
            return None
        pieces = []
        for mesh in loaded.dump():
            if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
                continue
            solid = Solid(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.uint32))
            pieces.append((solid, _color(mesh)))
        if not pieces:
            self.missing.append(f"{path}: holds no triangles")
            return None
        return pieces


def _one_line(error: Exception) -> str:
    text = str(error).strip().splitlines()
    return text[0] if text else type(error).__name__


def _color(mesh: object) -> tuple[int, int, int] | None:
    """The colour that a mesh has as a whole, if its file gives it one."""
    visual = getattr(mesh, "visual", None)
    if visual is None or not getattr(visual, "defined", False):
        return None
    color = getattr(visual, "main_color", None)
    if color is None:
        material = getattr(visual, "material", None)
        color = getattr(material, "main_color", None)
    if color is None:
        return None
    red, green, blue = (int(part) for part in color[:3])
    return red, green, blue
