//! Promise: a character gets the rotations of a subject, whatever its names, rest pose, bone axes and bone counts are.

mod feet;
mod names;
mod person;
mod rotations;
