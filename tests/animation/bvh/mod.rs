//! Motion capture from and to BVH.

mod channel_order;
mod malformed;
mod matrices;
mod positions;
mod round_trip;
mod shared;
