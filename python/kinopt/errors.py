"""What is raised: the library's own messages, below the exceptions that Python has for such cases."""


class KinoptError(Exception):
    """Everything that kinopt raises."""


class InvalidValueError(KinoptError, ValueError):
    """A value that cannot be: a wrong shape, NaN, a matrix that is no rotation, an option out of range."""


class UnknownNameError(InvalidValueError, KeyError):
    """A joint, frame or bone that does not exist; the message lists those that do."""

    # KeyError would put quotes around the message.
    __str__ = Exception.__str__


class InvalidFileError(KinoptError, ValueError):
    """A file that says what cannot be; the message names the file, the place and the problem."""


class FileError(KinoptError, OSError):
    """A file that cannot be read or written."""


__all__ = [
    "FileError",
    "InvalidFileError",
    "InvalidValueError",
    "KinoptError",
    "UnknownNameError",
]
