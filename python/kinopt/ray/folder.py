"""A folder of Parquet files, local or at a URI."""

from __future__ import annotations

import os
from typing import Any
from uuid import uuid4

import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet as pq
from pyarrow import fs

from ..errors import FileError

_UNFINISHED_SUFFIX = ".part"


class Folder:
    """Tables by name; a file appears when it is complete."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.name: str = os.fspath(folder)
        self.system: fs.FileSystem
        self.path: str
        try:
            if "://" in self.name:
                self.system, self.path = fs.FileSystem.from_uri(self.name)
            else:
                self.system, self.path = fs.LocalFileSystem(), os.path.abspath(self.name)
        except (OSError, pa.ArrowException) as error:
            raise FileError(f"{self.name} is not a folder: {error}") from None

    def path_of(self, name: str) -> str:
        return f"{self.path}/{name}"

    def make(self) -> None:
        """Creates the folder, and removes unfinished files of an interrupted job."""
        try:
            self.system.create_dir(self.path, recursive=True)
            for name in self._names(_UNFINISHED_SUFFIX):
                self.system.delete_file(self.path_of(name))
        except OSError as error:
            raise FileError(f"{self.name} cannot be written: {error}") from None

    def names(self) -> list[str]:
        """Names of its tables, in order."""
        try:
            return [name for name in self._names(".parquet") if name[0] not in "._"]
        except OSError as error:
            raise FileError(f"{self.name} cannot be read: {error}") from None

    def _names(self, ending: str) -> list[str]:
        files = self.system.get_file_info(fs.FileSelector(self.path))
        return sorted(file.base_name for file in files if file.is_file and file.base_name.endswith(ending))

    def stamp(self, name: str) -> str:
        """Text that changes when the file is replaced."""
        file = self.system.get_file_info(self.path_of(name))
        return f"{file.size} {file.mtime_ns}"

    def read(self, name: str) -> pa.Table:
        try:
            return pq.read_table(self.path_of(name), filesystem=self.system, partitioning=None)
        except (OSError, pa.ArrowException) as error:
            raise FileError(f"{name} in {self.name} cannot be read: {error}") from None

    def dataset(self, names: list[str]) -> pyarrow.dataset.Dataset:
        """Concatenated tables, unread."""
        paths = [self.path_of(name) for name in names]
        return pyarrow.dataset.dataset(paths, filesystem=self.system, format="parquet")

    def note(self, name: str, key: str) -> str | None:
        """Metadata of a table; None without it, and without a complete file."""
        try:
            notes = pq.read_schema(self.path_of(name), filesystem=self.system).metadata
        except (OSError, pa.ArrowException):
            return None
        note: Any = (notes or {}).get(key.encode())
        return note.decode() if note is not None else None

    def write(self, name: str, table: pa.Table, notes: dict[str, str] | None = None) -> None:
        """Writes a table to a temporary name first, so that no partial file appears."""
        table = table.replace_schema_metadata({**(table.schema.metadata or {}), **(notes or {})})
        unfinished = self.path_of(f".{name}.{uuid4().hex}{_UNFINISHED_SUFFIX}")
        try:
            pq.write_table(table, unfinished, filesystem=self.system, use_dictionary=False)
            self.system.move(unfinished, self.path_of(name))
        except OSError as error:
            raise FileError(f"{name} in {self.name} cannot be written: {error}") from None


__all__ = ["Folder"]
