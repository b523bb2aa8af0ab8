"""Optional dependencies."""

from __future__ import annotations

import importlib
from typing import Any


def load(module: str, extra: str, use: str) -> Any:
    """Imports a module of an optional dependency.

    Raises ``ImportError`` with the extra that installs it.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(f"{use} needs {package}: pip install 'kinopt[{extra}]'", name=package) from error


__all__ = ["load"]
