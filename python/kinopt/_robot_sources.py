"""Robots from xacro files and from the package robot_descriptions: class methods of ``Robot``."""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping
from importlib import import_module
from typing import Literal
from xml.parsers.expat import ExpatError

from ._kinopt import Robot
from .errors import FileError, InvalidFileError, InvalidValueError, UnknownNameError
from .types import BaseJoint


def from_xacro(
    path: str | os.PathLike[str],
    arguments: Mapping[str, object] | None = None,
    *,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    base_joint: BaseJoint | None = None,
    base_bounds: Mapping[str, tuple[float, float]] | None = None,
    lenient: bool = False,
    soft_limits: bool = False,
    mimic_limits: Literal["source", "both"] = "source",
) -> Robot:
    """Reads a xacro file: see ``Robot.from_xacro``."""
    try:
        from xacrodoc import packages as package_finder
        import xacro
    except ImportError as error:
        raise ImportError("Robot.from_xacro needs xacrodoc: pip install 'kinopt[xacro]'") from error
    file = os.fspath(path)
    package_finder.walk_up_from(file)
    package_finder.update_package_cache(packages or {})
    # As on xacro's command line: "true", not "True".
    values = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in (arguments or {}).items()}
    try:
        document = xacro.process_file(file, mappings=values, verbosity=0)
    except (package_finder.PackageNotFoundError, xacro.XacroException, ExpatError) as error:
        cause = getattr(error, "exc", None) or error
        if isinstance(cause, OSError):
            raise FileError(f"{file}: xacro: {error}") from error
        if isinstance(cause, package_finder.PackageNotFoundError):
            package = cause.args[0]
            raise InvalidFileError(f"{file}: no ROS package `{package}`: add its folder to `packages`") from error
        raise InvalidFileError(f"{file}: xacro: {error}") from error
    return Robot.from_urdf_text(
        document.toxml(),
        file,
        base_joint=base_joint,
        base_bounds=base_bounds,
        lenient=lenient,
        soft_limits=soft_limits,
        mimic_limits=mimic_limits,
    )


def from_description(
    name: str,
    arguments: Mapping[str, object] | None = None,
    *,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    base_joint: BaseJoint | None = None,
    base_bounds: Mapping[str, tuple[float, float]] | None = None,
    lenient: bool = False,
    mimic_limits: Literal["source", "both"] = "source",
) -> Robot:
    """Reads a robot of robot_descriptions: see ``Robot.from_description``."""
    try:
        from robot_descriptions import DESCRIPTIONS
    except ImportError as error:
        raise ImportError(
            "Robot.from_description needs robot_descriptions: pip install 'kinopt[descriptions]'"
        ) from error
    if name not in DESCRIPTIONS:
        similar = difflib.get_close_matches(name, DESCRIPTIONS, n=5, cutoff=0.4)
        raise UnknownNameError(f"no description named `{name}`; similar: {', '.join(similar) or 'none'}")
    try:
        description = import_module(f"robot_descriptions.{name}")
    except Exception as error:  # git's errors, whose package is a dependency of robot_descriptions
        raise FileError(f"{name}: its repository cannot be cloned: {error}") from error
    if hasattr(description, "XACRO_PATH") and not hasattr(description, "URDF_PATH"):
        return from_xacro(
            description.XACRO_PATH,
            {**getattr(description, "XACRO_ARGS", {}), **(arguments or {})},
            packages={**getattr(description, "XACRO_PACKAGE_PATHS", {}), **(packages or {})},
            base_joint=base_joint,
            base_bounds=base_bounds,
            lenient=lenient,
            mimic_limits=mimic_limits,
        )
    if arguments:
        raise InvalidValueError(f"{name}: its file is not xacro, so `arguments` must be empty")
    if hasattr(description, "URDF_PATH"):
        return Robot.from_urdf(
            description.URDF_PATH,
            base_joint=base_joint,
            base_bounds=base_bounds,
            lenient=lenient,
            mimic_limits=mimic_limits,
        )
    return Robot.from_mjcf(
        description.MJCF_PATH, base_joint=base_joint, base_bounds=base_bounds, mimic_limits=mimic_limits
    )
