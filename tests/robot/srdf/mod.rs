//! SRDF: groups, states, passive joints and disabled pairs of a robot.

mod lenient;
mod malformed;
mod semantics;
