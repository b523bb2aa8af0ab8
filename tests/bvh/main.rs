//! Motion capture from and to BVH.

mod malformed;
mod matrices;
mod positions;
mod round_trip;
mod shared;
