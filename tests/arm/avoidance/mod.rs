//! Collision avoidance of arms.

mod arm_avoidance;
mod free_path_following;
mod margin_beyond_reach;
mod narrow_gaps;
mod path_avoidance;
mod sphere_consistency;
mod time_limits;
mod unobstructed_tracks;
