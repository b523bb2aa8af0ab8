"""Exceptions of kinopt, derived from the matching built-in exceptions."""


class KinoptError(Exception):
    """Base class of all exceptions of kinopt."""


class InvalidValueError(KinoptError, ValueError):
    """An invalid value: a wrong shape, NaN, a matrix that is not a rotation, an option out of range."""


class UnknownNameError(InvalidValueError, KeyError):
    """An unknown joint, frame or bone; the message lists the valid names."""

    def __str__(self) -> str:
        # KeyError would put quotes around the message.
        return Exception.__str__(self)


class InvalidFileError(KinoptError, ValueError):
    """A file with invalid content; the message names the file, the position and the problem."""


class FileError(KinoptError, OSError):
    """A file that cannot be read or written."""


__all__ = [
    "FileError",
    "InvalidFileError",
    "InvalidValueError",
    "KinoptError",
    "UnknownNameError",
]
