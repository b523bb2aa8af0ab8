//! Promise: every public type can be printed, copied, shared between threads and sent to another. Every error works
//! with `?` and `anyhow`.

use std::error::Error;
use std::fmt::Debug;
use std::path::Path;

use kinopt::num_dual::DualSVec64;
use kinopt::scalar::Dual;
use kinopt::{
    BadOption, Model, Problem, SizeMismatch, Skeleton, Solution, Solver, Workspace, animation, arm,
    calibration, collision, geometric, ik, io, kinematics, mesh, model, motion, problem, robot,
    simd_ik, skeleton, skinning, solver, spatial, task,
};

const fn value<T: Clone + Debug + Send + Sync>() {}
const fn shared<T: Debug + Send + Sync + ?Sized>() {}
const fn shown<T: Debug>() {}
const fn error<T: Clone + Error + Send + Sync + 'static>() {}

macro_rules! each {
    ($promise:ident: $($t:ty,)*) => {
        $(const _: () = $promise::<$t>();)*
    };
}

each! { value:
    Model, model::ModelBuilder, model::Joint, model::JointKind, model::Frame, model::FrameId,
    model::JointId, model::Limits, model::LengthUnit, model::ParameterMap, model::Source,
    model::ParameterMapBuilder<'static>, model::Masses, model::PointMass, model::BallLimits, model::Loop, model::LoopKind,
    Skeleton, skeleton::SkeletonBuilder, skeleton::Bone, skeleton::BoneId, skeleton::Posing,
    skeleton::BonePlacements, skeleton::Hinge, skeleton::Holds,
    robot::Robot, robot::Mimic, robot::Link, robot::GeometryObject, robot::Geometry, robot::Inertial,
    robot::MjcfReader, robot::UrdfReader, robot::Repair, robot::RepairKind, robot::Srdf,
    kinematics::ForwardKinematics, kinematics::ForwardKinematics<Dual<6>>,
    spatial::Matrix3<f64>, spatial::Placement<f64>, spatial::Quaternion<f64>,
    spatial::Vector3<f64>, Dual<6>, DualSVec64<6>,
    mesh::TriangleMesh,
    collision::Shape, collision::ShapeKind, collision::ShapeNote, collision::Ball, collision::BoundingBox,
    collision::ConvexHull, collision::TriMesh, collision::HeightField, collision::PointCloud,
    collision::Separation, collision::World, collision::Obstacle, collision::MeshFile,
    collision::CollisionModel, collision::CollisionObject, collision::SphereModel, collision::SphereGroup,
    collision::Checker, collision::Collision,
    motion::trajectory::MotionProblem, motion::trajectory::MotionSolver, motion::trajectory::Windows, motion::trajectory::RateCost,
    motion::trajectory::Contact, motion::trajectory::MotionReport, motion::trajectory::MotionTermination,
    motion::trajectory::MotionCounts, motion::trajectory::MotionBound, motion::trajectory::MotionLimit<'static>,
    motion::trajectory::MotionMiss<'static>,
}

each! { value:
    animation::Aim, animation::AimGoal, animation::Armature, animation::ArmatureBone,
    animation::BezierEasing, animation::BlendClip, animation::BlendDefinition,
    animation::BoneMask, animation::Channel, animation::Character, animation::Clip,
    animation::ClipBuilder<'static>, animation::ConditionDefinition, animation::Crowd,
    animation::Cursor, animation::Decomposition, animation::Easing, animation::EndRotation,
    animation::EulerClip, animation::EulerCurve, animation::EulerInterpolation,
    animation::EulerKey, animation::EulerTrack, animation::Event, animation::Fired<'static>,
    animation::Interruption, animation::Layer, animation::LayerMode, animation::Limb,
    animation::LimbGoal, animation::LocalTransform, animation::MotionDefinition,
    animation::ParameterValue, animation::Passage, animation::PlaneDecomposition,
    animation::Playback, animation::Playhead, animation::PlayingClip, animation::Pose,
    animation::Property, animation::ReachLayer, animation::ScaleNote, animation::StateDefinition,
    animation::StateEvent<'static>, animation::StateMachine, animation::StateMachineDefinition,
    animation::StateMachineRun, animation::TransitionDefinition, animation::TriggerWord,
    animation::curve::BezierHandle<f32>, animation::curve::CubicBezier<f32>,
    animation::curve::Hermite<f32>, animation::curve::KeyRepair,
    animation::curve::KeyedCurve<f32>, animation::curve::Knots,
    animation::curve::TensionContinuityBias, animation::rotation::AxisAngle,
    animation::rotation::EulerAngles, animation::rotation::EulerOrder,
    animation::rotation::RotationCurve, animation::rotation::RotationHermite,
}

each! { value:
    skinning::AutomaticWeights, skinning::BlendShapes, skinning::BoneBoxes,
    skinning::CageBinding, skinning::DualQuaternion, skinning::DualQuaternionBlend<'static>,
    skinning::HeatWeights, skinning::Influence, skinning::LinearBlend<'static>,
    skinning::MeshWeights, skinning::MorphTarget, skinning::MorphTargets,
    skinning::PackedDualQuaternionBlend<'static>, skinning::PackedLinearBlend<'static>,
    skinning::PackedWeights, skinning::PointHandle, skinning::Pruning,
    skinning::RestVertices<'static>, skinning::SkinWeights, skinning::SkinWeightsBuilder,
    skinning::SkinningMethod, skinning::WeightRepair,
    io::FileAccess, io::FileLocation, io::bvh::BvhChannel, io::bvh::BvhFormat<'static>, io::bvh::BvhNote, io::bvh::MotionCapture,
    io::dmat::DmatEncoding, io::gltf::Note, io::gltf::Scene, io::gltf::SceneMesh,
    io::gltf::ScenePosing<&io::gltf::Scene>, io::gltf::Skin, io::gltf::WriteOptions, io::ply::PlyEncoding,
    io::c3d::MarkerCapture, io::numpy::NumpyArchive, io::numpy::NumpyArray, io::smpl::BodyModel, io::smpl::RestJoints, io::smpl::SmplArrays,
    io::smpl::SmplMotion, io::smpl::SmplNote,
    io::rig::Rig, io::rig::RigNote, io::rig::RigPosing<&io::rig::Rig>,
}

each! { value:
    Problem, Solution, Solver, Workspace, problem::Derivatives, problem::Preferences,
    problem::ProblemBuilder<'static>, problem::Scratch, problem::Targets,
    problem::TaskId<task::FramePose>, ik::ActiveLimit, ik::Restarts, ik::TaskReport, ik::OpenLoop, ik::LoopClosure<'static>, ik::LoopGap,
    solver::GaussNewton, solver::LevenbergMarquardt, solver::ProjectedGradient,
    solver::Stopping, solver::Termination, geometric::Ccd, geometric::Elbow, geometric::Fabrik,
    geometric::TwoBone, task::Camera, task::CentreOfMass, task::Distance, task::FrameVelocity,
    task::Gaze, task::JointCoupling, task::Manipulability, task::SupportPolygon, task::LimitCentring, task::LookAt,
    task::Orientation, task::Pixel, task::Plane, task::Point, task::FramePose, task::Posture,
    task::Quantity, task::Ray, task::Role, task::RowBlock, task::Smoothness,
    arm::ArmBuilder<'static>, arm::PoseBounds, arm::Reachability, arm::ServoStatus, arm::JointPath<()>,
    arm::ArmFingerprint, arm::BasePlacement, arm::CellReach, arm::PoseReach, arm::ReachMap, arm::ReachMapBuilder<'static>,
    arm::ReachMapData, simd_ik::Chain, simd_ik::LaneOptions,
}

each! { value:
    motion::ContactDetection, motion::posing::GuessedHinge, motion::posing::HingeSource,
    motion::posing::StandingDrag, motion::posing::StandingDragBuilder<'static>, motion::trajectory::MotionProblemBuilder<'static>, motion::clip_ik::ClipIk<'static>,
    motion::clip_ik::BeyondLimit, motion::clip_ik::EditReport, motion::clip_ik::EditedClip, motion::clip_ik::EditedKeys, motion::clip_ik::KeyframeIk<'static>,
    motion::clip_ik::ReachResult, motion::clip_ik::Reach, motion::clip_ik::FootPlant, motion::path::Blocked,
    motion::path::CartesianPath, motion::path::Curve, motion::path::Traversal, motion::path::CsvColumns, motion::path::Deviation,
    motion::path::MissReason, motion::path::Missed, motion::path::PathReport,
    motion::path::PathSolver<'static>, motion::path::QuaternionOrder,
    motion::retarget::BodyFollower, motion::retarget::BodyMap, motion::retarget::BodyPart,
    motion::retarget::Capture, motion::retarget::Drive, motion::retarget::FigureTarget,
    motion::retarget::FootShapes, motion::retarget::JointRotations, motion::retarget::LostContact,
    motion::retarget::KnownSkeleton,
    motion::retarget::LimitMet, motion::retarget::LiveFollower, motion::retarget::MapGuess,
    motion::retarget::RetargetOptions, motion::retarget::RetargetReport, motion::retarget::Retargeting<'static>,
    motion::retarget::Touching, motion::retarget::UpAxis,
    motion::score::CollisionShare, motion::score::EndError, motion::score::FootMotion, motion::score::GroundPenetration,
    motion::score::Heading, motion::score::JerkScore, motion::score::LimbAngle, motion::score::LimitExcess,
    motion::score::LostSubjectContact, motion::score::MotionScore, motion::score::MotionScorer<'static>,
    motion::score::ScoreTerm, motion::score::ScoreWeights, motion::score::Spread,
    motion::retarget::Touching, motion::retarget::UpAxis, motion::retarget::Terrain, motion::retarget::TerrainPatch,
    motion::retarget::HeldObject, motion::retarget::ObjectShape, motion::retarget::Finger, motion::retarget::FingerDrive,
    motion::retarget::HandMap, motion::retarget::HandReport, motion::retarget::HandRetargeting<'static>,
    motion::retarget::HandFollower,
}

each! { value:
    calibration::Calibration, calibration::Calibrated, calibration::Correction, calibration::Measurements<'static>,
    calibration::Noise, calibration::ParameterEstimate, calibration::ParameterSet, calibration::Prior, calibration::Rms,
}

each! { value:
    animation::KeyTolerance, animation::ParameterDefault, animation::EulerPoseMap, animation::BallPoseMap,
    animation::RootMotion, arm::AllSolutions, arm::Argument, arm::Arm, arm::ArmDerivative, arm::Axis, arm::Base<'static>,
    arm::ArmBranch, arm::Criterion<'static>, arm::ElbowBranch, arm::GoalOutcome, arm::GoalSet, arm::GoalSetSolution,
    arm::GoalStatus, arm::PoseSolution, arm::SelfMotion, arm::ShoulderBranch, arm::WristBranch,
    arm::Follower<'static>, arm::HeldBy, arm::PoseOutcome, arm::Search, arm::Servo<'static>,
    arm::ServoStep<'static>, motion::path::TimingLimits<'static>, motion::path::TimedSpline, motion::Trajectory<()>,
    motion::path::TrajectoryPoint, collision::BodyKind, collision::CheckerWorkspace, collision::Clearance,
    collision::CollisionModelBuilder<'static>, collision::Resolution, collision::MeshUse, collision::MotionCheck,
    collision::MotionChecker, geometric::Reaching, geometric::Span, geometric::Triangle, ik::BoundKind,
    ik::DerivativeWorkspace, ik::Drag, ik::Differentiability, ik::JointJump, ik::MotionLimits, ik::MoveLimits, ik::NoDerivative,
    ik::RowBlockReport, ik::Side, io::gltf::SceneFile, kinematics::Jacobian, simd_ik::AxisGoal, simd_ik::ChainJoint,
    simd_ik::JointKind, simd_ik::PoseSolver, simd_ik::Prefer, simd_ik::lane::LaneMask<4>,
    simd_ik::lane::Lanes<4, false>, model::Reference<'static, model::FrameId>, problem::ParameterVector,
    problem::ProblemInstance<'static>, robot::BaseJoint, robot::DisabledPair, robot::EndEffector, robot::Group,
    robot::GroupState, robot::MissingInertia, robot::SrdfReader, robot::VirtualJoint, skeleton::BallSkeleton,
    skeleton::BoneCone, skeleton::SkeletonRoot, skinning::BoneVolume, solver::ConfigurationSpace<'static>,
    solver::Counts, solver::Damping, solver::FirstStep, solver::GaussNewtonState,
    solver::Iteration<'static>, solver::LevenbergMarquardtState, solver::Outcome,
    solver::ProjectedGradientState, solver::Silent, solver::SolverState, solver::Step, task::LocalJacobian,
    task::Numeric<task::Point>, task::Inequality, task::Inputs, task::Description, task::Task<task::Point>, task::Bounded<task::Point>,
}

// Each borrows the caller's memory exclusively.
each! { shared:
    task::Extensions<task::Point>,
    ik::SolutionDerivative<'static>, problem::Evaluation<'static>, skinning::PosedVertices<'static>,
}
// Borrows the caller's memory exclusively, and a problem of any kind.
each! { shown: solver::Iterate<'static>, }

each! { error:
    collision::ShapeError, collision::WorldError, collision::CollisionModelError,
    motion::trajectory::MotionError, animation::LayerError, animation::ClipError,
    animation::HandleError, animation::NoEffector, animation::NotFinite, animation::SizeMismatch,
    animation::StateMachineError, animation::curve::KeyError, arm::ArmError, arm::QueryError, arm::ReachMapError,
    ik::SolveError, io::ReadError, io::ReadProblem, io::WriteError, io::FormatError,
    io::gltf::SceneError, io::gltf::UnwritableScene, kinematics::KinematicsError, model::ModelError,
    skinning::SkinningError, mesh::MeshError, model::UnknownName, problem::ProblemError,
    robot::RobotFileError, calibration::CalibrationError, skinning::UnknownSkinning, spatial::NotRigid, spatial::RigidDefect,
    BadOption, SizeMismatch, simd_ik::LaneError, motion::clip_ik::ClipIkError,
    motion::path::PathError, motion::retarget::RetargetError, motion::score::ScoreError, io::smpl::SmplError, io::c3d::MarkerError,
    motion::posing::StandingDragError,
    robot::ParseIssue,
}

#[test]
fn methods_and_deformations_can_be_boxed_and_sent() {
    fn sent<T: Send + ?Sized>() {}
    sent::<dyn solver::AnyMethod>();
    sent::<Box<dyn skinning::Deformation + Send>>();
}

/// Names of the types in the interface of a folder's sources: those that are `pub` and not hidden.
fn declared(folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            declared(&path, found);
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let mut hidden = false;
        for line in text.lines() {
            let kinds = ["pub struct ", "pub enum "];
            hidden |= line == "#[doc(hidden)]";
            let declaration = kinds.iter().find_map(|kind| line.strip_prefix(kind));
            if let (Some(rest), false) = (declaration, hidden) {
                let name = rest.split(|c: char| !c.is_alphanumeric()).next();
                found.extend(name.map(str::to_owned));
            }
            hidden &= line.starts_with(['#', '/', ' ', ')']);
        }
    }
}

#[test]
fn every_public_type_is_listed() {
    let above = include_str!("public_types.rs");
    // The bridge to argmin has tests of its own (`examples/rust/argmin/tests`), with its feature.
    let words = above.split(|c: char| !c.is_alphanumeric()).chain(BRIDGE);
    let words: Vec<&str> = words.collect();
    let mut found = Vec::new();
    for package in std::fs::read_dir("../crates").unwrap() {
        let package = package.unwrap().path();
        // Interfaces of other languages.
        if !package.ends_with("kinopt-bindings") && !package.ends_with("kinopt-c") {
            declared(&package.join("src"), &mut found);
        }
    }
    assert!(found.len() > 300);
    found.retain(|name| !words.contains(&name.as_str()));
    assert!(found.is_empty(), "{found:?} are to be listed above");
}

/// Tested in `examples/rust/argmin/tests/bridge/promises.rs`.
const BRIDGE: [&str; 4] = [
    "BoundedProblem",
    "UnboundedProblem",
    "ExecutorMethod",
    "BridgeError",
];
