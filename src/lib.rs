//! Inverse kinematics by optimisation.
//!
//! A model (a robot arm, a character's skeleton) has joint values q with hard bounds. A task is a residual r(q) of its
//! frames or joints. Inverse kinematics is then one bounded nonlinear least-squares problem:
//!
//! ```text
//! minimise  cost(q) = ½ Σ ‖W r(q)‖²     subject to  q_min ≤ q ≤ q_max
//! ```
//!
//! Build a [`Model`] by hand, from a [`Skeleton`], or from a URDF. State a [`Problem`] of [`task`]s
//! and pass it to a [`Solver`]. The [`Solution`] reports the reached tasks, the errors of all others, and the active
//! limits.
//!
//! ```
//! use kinopt::model::{Limits, Model};
//! use kinopt::spatial::{Placement, Vector3};
//! use kinopt::task::Point;
//! use kinopt::{Problem, Solver};
//!
//! // Two links of one metre in the xy plane.
//! let mut builder = Model::builder("two links");
//! let z = Vector3::new(0.0, 0.0, 1.0);
//! let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
//! let limits = Limits::new(-2.5, 2.5);
//! let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
//! let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
//! let tip = builder.frame("tip", Some(elbow), link);
//! let model = builder.build()?;
//!
//! let mut tasks = Problem::builder(&model);
//! tasks.add(Point::new(tip, [1.0, 1.0, 0.0]));
//! let solution = Solver::default().solve_once(&tasks.build()?, &[0.1, 0.1])?;
//! assert!(solution.reached);
//! assert!((solution.q[1].abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Motion over time is in `animation`, skin deformation in `skinning`. Their poses and meshes use the types of
//! [`glam`]; tables of weights use those of [`nalgebra`].
//!
//! # Conventions
//!
//! - Units are metres (for rigs, the rig's unit), radians and seconds.
//! - Frames are right-handed, vectors are columns. A placement `world_from_tip` maps tip coordinates to world
//!   coordinates.
//! - Quaternions are w, x, y, z.
//! - Velocities are linear first, then angular, in world axes at the frame's origin.
//! - Models and optimisation use `f64`, meshes `f32`.
//! - Functions that take geometry accept the types of [`nalgebra`] and [`glam`] too.
//!
//! Wrong lengths, numbers that are not finite, ids of another model and settings out of range return an `Err` that
//! names them. Animated interpolation parameters and weights (of a layer, a task, a cross-fade) may overshoot. They are
//! clamped to [0, 1], and NaN counts as 0.
//!
//! Methods that add parts take `&mut self` and return ids or handles. Methods that set options take and return `self`;
//! on finished objects their names start with `with_`.
//!
//! # Features
//!
//! `urdf` is on by default.
//!
//! - `arm`: robot arms and Cartesian paths; every feature for robots enables it
//! - `animation`: keyframe animation, skinning, files of characters
//! - `motion`: trajectory optimisation, clip IK, retargeting, scores of motions
//! - `c3d`: markers from C3D files
//! - `collision`: shapes, distances, worlds of obstacles, collision avoidance of arms
//! - `urdf`: robots from URDF
//! - `mjcf`: robots from MuJoCo's XML
//! - `yaml`: joint limits from MoveIt's YAML
//! - `gltf`: scenes from and to glTF
//! - `draco`: Draco-compressed meshes of glTF files
//! - `heat`: skin weights by bone heat weighting
//! - `npz`: NumPy's `.npz` files, motions of the SMPL family
//! - `rayon`: batches on several threads
//! - `serde`: serialisation of models, options, solutions and clips
//! - `argmin`: the bridge to argmin
//! - `num-dual`: dual numbers of the crate num-dual as scalars

#![warn(clippy::disallowed_methods)]
// On docs.rs every item shows the feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "animation")]
#[doc(inline)]
pub use kinopt_animation::{animation, io, skinning};
#[cfg(feature = "argmin")]
#[doc(inline)]
pub use kinopt_argmin::argmin_bridge;
#[cfg(feature = "arm")]
#[doc(hidden)] // For tests and measurements.
pub use kinopt_arm::simd_ik;
#[cfg(feature = "arm")]
#[doc(inline)]
pub use kinopt_arm::{Arm, arm, calibration};
#[cfg(feature = "collision")]
#[doc(inline)]
pub use kinopt_collision::collision;
#[doc(hidden)] // Used by the command line and the Python package.
pub use kinopt_kinematics::plural::counted;
#[doc(inline)]
pub use kinopt_kinematics::{
    BadOption, Buffer, Model, Scalar, SizeMismatch, Skeleton, clock, interruption, kinematics,
    model, scalar, skeleton, spatial,
};
#[cfg(any(feature = "animation", feature = "collision"))]
#[doc(inline)]
pub use kinopt_mesh::mesh;
#[cfg(feature = "arm")]
#[doc(inline)]
pub use kinopt_robot::robot;
#[doc(inline)]
pub use kinopt_solver::{
    Problem, Solution, Solver, Workspace, geometric, ik, problem, solver, task,
};

/// Motion over time: Cartesian paths, trajectories, clip IK and retargeting.
#[cfg(any(feature = "arm", feature = "motion"))]
pub mod motion {
    #[cfg(feature = "arm")]
    #[doc(inline)]
    pub use kinopt_arm::path;
    #[doc(inline)]
    pub use kinopt_kinematics::Trajectory;
    #[cfg(feature = "motion")]
    #[doc(inline)]
    pub use kinopt_motion::motion::*;
}

pub mod prelude;

// These crates' types are part of the interface; another version in a caller's crate would not match.
pub use glam;
#[cfg(feature = "num-dual")]
pub use kinopt_kinematics::num_dual;
pub use nalgebra;

/// Examples of the guide and the reference, run as tests.
#[cfg(all(doctest, feature = "urdf"))]
#[doc = include_str!("../docs/guide/arms.md")]
#[doc = include_str!("../docs/guide/balance.md")]
#[doc = include_str!("../docs/guide/batches.md")]
#[doc = include_str!("../docs/guide/characters.md")]
#[doc = include_str!("../docs/guide/clip-ik.md")]
#[doc = include_str!("../docs/guide/clips.md")]
#[doc = include_str!("../docs/guide/complete-solutions.md")]
#[doc = include_str!("../docs/guide/derivatives.md")]
#[doc = include_str!("../docs/guide/dragging.md")]
#[doc = include_str!("../docs/guide/followers.md")]
#[doc = include_str!("../docs/guide/gaze.md")]
#[doc = include_str!("../docs/guide/paths.md")]
#[doc = include_str!("../docs/guide/pose-ik.md")]
#[doc = include_str!("../docs/guide/postures.md")]
#[doc = include_str!("../docs/guide/priorities.md")]
#[doc = include_str!("../docs/guide/reach-maps.md")]
#[doc = include_str!("../docs/guide/reachability.md")]
#[doc = include_str!("../docs/guide/residuals.md")]
#[doc = include_str!("../docs/guide/retargeting-robots.md")]
#[doc = include_str!("../docs/guide/retargeting.md")]
#[doc = include_str!("../docs/guide/scores.md")]
#[doc = include_str!("../docs/guide/servo.md")]
#[doc = include_str!("../docs/guide/skinning.md")]
#[doc = include_str!("../docs/guide/targets.md")]
#[doc = include_str!("../docs/guide/trajectories.md")]
#[doc = include_str!("../docs/guide/trajectory-optimisation.md")]
#[doc = include_str!("../docs/guide/whole-bodies.md")]
#[doc = include_str!("../docs/reference/file-access.md")]
struct Guide;

/// Examples of the guide that read MJCF, run as tests.
#[cfg(all(doctest, feature = "urdf", feature = "mjcf"))]
#[doc = include_str!("../docs/guide/closed-loops.md")]
struct MjcfGuide;

/// Examples of the guide with obstacles, run as tests.
#[cfg(all(doctest, feature = "collision", feature = "urdf"))]
#[doc = include_str!("../docs/guide/body-collision-avoidance.md")]
#[doc = include_str!("../docs/guide/collision-avoidance.md")]
#[doc = include_str!("../docs/guide/collision-models.md")]
#[doc = include_str!("../docs/guide/retargeting-collisions.md")]
#[doc = include_str!("../docs/guide/worlds.md")]
struct CollisionGuide;

/// Examples of the guide that read and write glTF, run as tests.
#[cfg(all(doctest, feature = "gltf"))]
#[doc = include_str!("../docs/guide/file-formats.md")]
struct GltfGuide;

/// Examples of the README, run as tests.
#[cfg(all(doctest, feature = "urdf"))]
#[doc = include_str!("../README.md")]
struct Readme;
