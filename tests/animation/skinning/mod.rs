//! Skinning, morph targets, weights and cages.

mod automatic_weights;
mod blend_shapes;
mod bone_volumes;
mod cage_coordinates;
mod dual_quaternion_skinning;
mod exact_lengths;
mod heat_weights;
mod linear_blend_skinning;
mod morph_targets;
mod packed_skinning;
mod parallel_skinning;
mod point_handles;
mod portable_paths;
mod reference;
mod skin_weights;
mod skinned_bounds;
mod surface_frames;
mod twisted_tube;
