//! Extension module of the Python package `kinopt`: the concepts and names of the Rust library, with arrays instead of
//! slices.
//!
//! Every class stores the data that rebuild it, for pickling and copying. No object changes through another one.

use kinopt_bindings::option::{self, documentation};
use pyo3::PyTypeInfo;
use pyo3::prelude::*;

mod animation;
mod arm;
mod arrays;
mod calibration;
mod capture;
mod cartesian_path;
mod collision;
mod configuration;
mod contents;
mod coordinates;
mod error;
mod file_access;
mod goal;
mod has_model;
mod in_python;
mod io;
mod items;
mod joint_jump;
mod joint_path;
mod kinematics;
mod loops;
mod masses;
mod mesh;
mod model;
mod motion;
mod named_configuration;
mod named_loop;
mod object;
mod path;
mod pickling;
mod placement;
mod pool;
mod posing;
mod problem;
mod progress;
mod retargeting;
mod rig;
mod robot;
mod scene;
mod signals;
mod skeleton;
mod skinning;
mod solution;
mod solver;
mod srdf;
mod threads;
mod trajectory;
mod transforms;
mod vertices;
mod world;

/// Compiled part of kinopt: inverse kinematics by optimisation.
#[pymodule]
mod _kinopt {
    #[pymodule_export]
    use super::animation::animation;
    #[pymodule_export]
    use super::arm::{
        AllSolutions, Arm, ArmDerivative, BasePlacement, Batch, Follower, GoalSetSolution,
        ReachMap, Reachability, SelfMotion, Servo, ServoStep, solve_goals,
    };
    #[pymodule_export]
    use super::calibration::{Calibration, calibrate};
    #[pymodule_export]
    use super::capture::MotionCapture;
    #[pymodule_export]
    use super::cartesian_path::CartesianPath;
    #[pymodule_export]
    use super::collision::{CollisionModel, SphereModel};
    #[pymodule_export]
    use super::coordinates::Coordinates;
    #[pymodule_export]
    use super::goal::PoseBounds;
    #[pymodule_export]
    use super::io::io;
    #[pymodule_export]
    use super::joint_jump::JointJump;
    #[pymodule_export]
    use super::joint_path::JointPath;
    #[pymodule_export]
    use super::kinematics::{ForwardKinematics, Jacobian, frame_jacobian, frame_placement};
    #[pymodule_export]
    use super::loops::LoopClosure;
    #[pymodule_export]
    use super::mesh::TriangleMesh;
    #[pymodule_export]
    use super::model::{Frame, Joint, Model, ModelBuilder};
    #[pymodule_export]
    use super::motion::{ActiveMotionLimit, MissedFrame, MotionProblem, MotionReport};
    #[pymodule_export]
    use super::path::{MissedPoint, PathReport, solve_path};
    #[pymodule_export]
    use super::placement::interpolate;
    #[pymodule_export]
    use super::posing::StandingDrag;
    #[pymodule_export]
    use super::problem::{ParameterMap, Problem, SolutionDerivative};
    #[pymodule_export]
    use super::retargeting::retargeting;
    #[pymodule_export]
    use super::rig::{Rig, RigPosing};
    #[pymodule_export]
    use super::robot::{Robot, Shape};
    #[pymodule_export]
    use super::scene::{Scene, SceneFile, SceneMesh, ScenePosing, Skin};
    #[pymodule_export]
    use super::skeleton::{BallSkeleton, Bone, Skeleton, SkeletonBuilder};
    #[pymodule_export]
    use super::skinning::skinning;
    #[pymodule_export]
    use super::solution::{ActiveLimit, Collision, Counts, RowBlockReport, Solution, TaskReport};
    #[pymodule_export]
    use super::solver::{Drag, Iteration, Solutions, Solver};
    #[pymodule_export]
    use super::srdf::Srdf;
    #[pymodule_export]
    use super::trajectory::{TimedSpline, Trajectory, TrajectoryPoint};
    #[pymodule_export]
    use super::world::{Obstacle, Separation, World};

    use super::*;

    /// Cameras, and helpers for tasks.
    #[pymodule]
    mod tasks {
        #[pymodule_export]
        use crate::problem::{Camera, goal, numbers, placement, rotation, target};
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        document::<Arm>(module, &documentation(&option::arm::options()))?;
        document::<Solver>(module, &documentation(&option::solver::options()))?;
        register(
            module,
            &["animation", "io", "retargeting", "skinning", "tasks"],
        )
    }
}

/// Adds the documentation of options to that of a class, before its errors.
fn document<T: PyTypeInfo>(module: &Bound<'_, PyModule>, options: &str) -> PyResult<()> {
    let class = module.py().get_type::<T>();
    let documentation: String = class.getattr("__doc__")?.extract()?;
    let errors = format!("{options}\n\nRaises ");
    class.setattr("__doc__", documentation.replacen("Raises ", &errors, 1))
}

/// Makes the submodules of `module` importable under their full names.
fn register(module: &Bound<'_, PyModule>, inside: &[&str]) -> PyResult<()> {
    let loaded = module.py().import("sys")?.getattr("modules")?;
    for name in inside {
        loaded.set_item(format!("kinopt._kinopt.{name}"), module.getattr(*name)?)?;
    }
    Ok(())
}
