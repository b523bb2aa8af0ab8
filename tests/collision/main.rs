//! Promises of kinopt-collision: shapes, distances, worlds and avoidance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod allowed_collisions;
mod attached_objects;
mod avoidance_priority;
mod checkers;
mod coal;
mod collision_models;
mod convex_decomposition;
mod depenetration;
mod distance_certificates;
mod distance_identities;
mod exact_contacts;
mod grazing_motions;
mod ground_height;
mod immobile_links;
mod invalid_shapes_and_files;
mod large_hulls;
mod mesh_files;
mod minimum_penetration;
mod mjcf_contacts;
mod package_manifests;
mod robot_avoidance;
mod sampled_pairs;
mod scaled_worlds;
mod shapes;
mod skin_capsules;
mod sphere_checks;
mod sphere_covers;
mod sphere_files;
mod starts_in_contact;
mod thin_walls;
mod world_files;
mod world_updates;
mod worlds;
