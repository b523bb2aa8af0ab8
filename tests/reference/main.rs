//! Numbers of programs that share no code with kinopt.

mod digest;
mod every_joint;
mod interpolation;
mod kinematics;
mod minima;
mod problems;
mod robot_texts;
mod same_arms;
mod same_bits;
mod same_bodies;
mod same_courses;
mod same_following;
mod same_mjcf;
mod same_model_refusals;
mod same_models;
mod same_motions;
mod same_numbers;
mod same_on_the_web;
mod same_placements;
mod same_robots;
mod same_semantics;
mod same_targets;
mod same_tasks;
mod same_weights;
mod same_worlds;
mod skinning;
