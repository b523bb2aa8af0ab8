"""Search for the mesh files of a robot."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

from .solids import Solid

#: Environment variables with folders of ROS packages.
PACKAGE_PATHS = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH")


class MeshFiles:
    """Finds and reads mesh files: STL, OBJ, PLY, glTF, and COLLADA if pycollada is installed."""

    def __init__(
        self,
        beside: Path | None = None,
        packages: Mapping[str, str | Path] | Iterable[str | Path] = (),
        confine: bool = False,
    ) -> None:
        """Arguments: the folder of the robot, and folders of packages by name, or folders that contain packages.

        With `confine` no file outside these folders is opened.
        """
        self._beside = beside
        self._confine = confine
        self._named: dict[str, Path] = {}
        self._folders: list[Path] = []
        if isinstance(packages, Mapping):
            self._named = {name: Path(folder) for name, folder in packages.items()}
        else:
            self._folders = [Path(folder) for folder in packages]
        #: Files that cannot be drawn, one line each.
        self.missing: list[str] = []

    def find(self, file: str) -> Path | None:
        """Path of a mesh named `package://…`, `file://…`, or by a path; None if it is missing."""
        return next(
            (path for path in self._candidates(file) if self._is_allowed(path) and path.is_file()), None
        )

    def _is_allowed(self, candidate: Path) -> bool:
        if not self._confine:
            return True
        roots = [*self._named.values(), *self._folders, *([] if self._beside is None else [self._beside])]
        real = candidate.resolve()
        return any(real.is_relative_to(root.resolve()) for root in roots)

    def _candidates(self, file: str) -> Iterable[Path]:
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
            # The file of a robot is usually within the package of its meshes.
            yield self._beside
            yield from self._beside.parents
        for variable in PACKAGE_PATHS:
            yield from (Path(folder) for folder in os.environ.get(variable, "").split(os.pathsep) if folder)

    def read(self, file: str) -> list[tuple[Solid, tuple[int, int, int] | None]] | None:
        """Parts of a mesh with their colours; None, and a line in `missing`, if it cannot be read."""
        import numpy as np
        import trimesh

        path = self.find(file)
        if path is None:
            self.missing.append(f"{file}: not found")
            return None
        try:
            # Materials and buffers of the mesh are opened only below its own folder.
            with path.open("rb") as opened:
                resolver = below(path.parent)
                loaded = trimesh.load_scene(opened, file_type=path.suffix.lower().lstrip("."), resolver=resolver)
        except Exception as error:  # noqa: BLE001 - readers of many formats raise what they like
            # The messages may quote the file, whose path comes from the robot's file.
            self.missing.append(f"{path}: cannot be read ({type(error).__name__})")
            return None
        pieces = []
        for mesh in loaded.dump():
            if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
                continue
            solid = Solid(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.uint32))
            pieces.append((solid, _color(mesh)))
        if not pieces:
            self.missing.append(f"{path}: contains no triangles")
            return None
        return pieces


def below(folder: Path) -> Any:
    """Resolver that opens the files of a mesh only below a folder."""
    from trimesh.resolvers import FilePathResolver

    class Below(FilePathResolver):
        def get(self, name: str) -> bytes:
            path = (folder / name.strip()).resolve()
            if not path.is_relative_to(folder.resolve()):
                raise ValueError(f"{name}: outside of {folder}")
            return path.read_bytes()

    return Below(str(folder))


def _color(mesh: object) -> tuple[int, int, int] | None:
    """Colour of a whole mesh, if its file has one."""
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
