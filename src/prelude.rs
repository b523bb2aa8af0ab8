//! The types that most programs need: `use kinopt::prelude::*;`.
//!
//! ```
//! use kinopt::prelude::*;
//!
//! let mut builder = Model::builder("arm");
//! let z = Vector3::new(0.0, 0.0, 1.0);
//! let joint = builder.revolute("joint", None, Placement::identity(), z, Limits::new(-2.0, 2.0));
//! let tip = builder.frame("tip", Some(joint), Vector3::new(1.0, 0.0, 0.0));
//! let model = builder.build()?;
//! let mut tasks = Problem::builder(&model);
//! tasks.add(Point::new(tip, [0.0, 1.0, 0.0]));
//! let solution = Solver::default().solve_once(&tasks.build()?, &model.neutral())?;
//! assert!(solution.reached);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "arm")]
pub use crate::arm::{Arm, PoseBounds};
pub use crate::ik::{Drag, Solution, Solver, Workspace};
pub use crate::kinematics::{ForwardKinematics, frame_jacobian};
pub use crate::model::{FrameId, JointId, Limits, Model, ParameterMap};
pub use crate::problem::Problem;
#[cfg(feature = "arm")]
pub use crate::robot::Robot;
pub use crate::skeleton::{Bone, BoneId, Skeleton};
pub use crate::spatial::{Matrix3, Placement, Vector3};
pub use crate::task::{FramePose, Orientation, Point, Task};
