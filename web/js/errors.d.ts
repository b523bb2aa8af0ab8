/** Base class of all exceptions of kinopt. */
export class KinoptError extends Error {}
/** An invalid value: a wrong length, NaN, a matrix that is not a rotation, an option out of range. */
export class InvalidValueError extends KinoptError {}
/** An unknown joint, frame, bone or option; the message lists the valid names. */
export class UnknownNameError extends InvalidValueError {}
/** A file with invalid content; the message has the file, the position and the problem. */
export class InvalidFileError extends KinoptError {}
/** A file that cannot be read. */
export class FileError extends KinoptError {}
