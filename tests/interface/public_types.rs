//! Promise: every public type can be printed, copied, shared between threads and sent to another; every
//! error is one that `?` and `anyhow` take.

use std::error::Error;
use std::fmt::Debug;

use kinopt::scalar::Dual;
use kinopt::{
    Model, Problem, Skeleton, Solution, Solver, Workspace, animation, arm, collision, geometric,
    ik, io, kinematics, lanes, mesh, model, motion, problem, robot, skeleton, skinning, solver,
    spatial, task,
};

const fn value<T: Clone + Debug + Send + Sync>() {}
const fn shared<T: Debug + Send + Sync + ?Sized>() {}
const fn error<T: Error + Send + Sync + 'static>() {}

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
    skeleton::BonePlacements, skeleton::Holds,
    robot::Robot, robot::Mimic, robot::Link, robot::Shape, robot::Geometry, robot::Inertial,
    robot::UrdfReader, robot::Repair, robot::Mended, robot::Srdf,
    kinematics::ForwardKinematics, kinematics::ForwardKinematics<Dual<6>>,
    spatial::Matrix3<f64>, spatial::Placement<f64>, spatial::Quaternion<f64>,
    spatial::Vector3<f64>, Dual<6>,
    mesh::TriangleMesh,
    collision::Shape, collision::ShapeKind, collision::ShapeNote, collision::Ball, collision::BoundingBox,
    collision::ConvexHull, collision::TriangleMesh, collision::HeightField, collision::PointCloud,
    collision::Separation, collision::World, collision::Obstacle, collision::MeshFile,
    collision::CollisionModel, collision::CollisionObject, collision::SphereModel, collision::SphereGroup,
    collision::Checker, collision::Collision,
    motion::clip::MotionProblem, motion::clip::MotionSolver, motion::clip::Windows, motion::clip::RateCost,
    motion::clip::Contact, motion::clip::MotionSolution, motion::clip::MotionTermination,
    motion::clip::MotionCounts, motion::clip::MotionBound, motion::clip::MotionLimit<'static>,
    motion::clip::MotionMiss<'static>,
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
    animation::Property, animation::ReachLayer, animation::StateDefinition,
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
    skinning::SkinningMethod, skinning::TwistedTube, skinning::WeightRepair,
    io::Place, io::bvh::BvhChannel, io::bvh::BvhNote, io::bvh::MotionCapture,
    io::dmat::DmatEncoding, io::gltf::Note, io::gltf::Scene, io::gltf::SceneMesh,
    io::gltf::ScenePosing<&io::gltf::Scene>, io::gltf::Skin, io::gltf::WriteOptions, io::ply::PlyEncoding,
    io::rig::Rig, io::rig::RigNote, io::rig::RigPosing<&io::rig::Rig>,
}

each! { value:
    Problem, Solution, Solver, Workspace, problem::Derivatives, problem::Preferences,
    problem::ProblemBuilder<'static>, problem::Scratch, problem::Targets,
    problem::TaskId<task::Pose>, ik::ActiveLimit, ik::Restarts, ik::TaskReport, ik::OpenLoop, ik::LoopClosure<'static>, ik::LoopGap,
    solver::GaussNewton, solver::LevenbergMarquardt, solver::ProjectedGradient,
    solver::Stopping, solver::Termination, geometric::Ccd, geometric::Elbow, geometric::Fabrik,
    geometric::TwoBone, task::Camera, task::CentreOfMass, task::Distance, task::FrameVelocity,
    task::Gaze, task::JointCoupling, task::Manipulability, task::SupportPolygon, task::LimitCentring, task::LookAt,
    task::Orientation, task::Pixel, task::Plane, task::Point, task::Pose, task::Posture,
    task::Quantity, task::Ray, task::Role, task::Rows, task::Smoothness,
    arm::ArmBuilder<'static>, arm::Goal, arm::Jump, arm::ServoStatus, arm::Track,
    lanes::Chain, lanes::LaneOptions,
}

// Lent parts of something, or memory that is filled again rather than copied.
each! { shared:
    arm::Arm, arm::Servo<'static>, ik::Drag, problem::Evaluation<'static>,
    skinning::PosedVertices<'static>,
}

each! { error:
    collision::ShapeError, collision::WorldError, collision::CollisionModelError, collision::CheckerError,
    motion::clip::MotionError,
    animation::AimError, animation::ArmatureError, animation::BlendError,
    animation::ChannelError, animation::ClipError, animation::ClipNameError,
    animation::HandleError, animation::LimbError, animation::LocalError, animation::NoEffector,
    animation::NotFinite, animation::ParameterError, animation::ReachError,
    animation::SampleError, animation::SizeMismatch, animation::StateMachineError,
    animation::StateMachineProblem, animation::curve::KeyError, arm::ArmError, arm::QueryError,
    geometric::GeometricError, ik::SolveError, io::ReadError, io::ReadProblem, io::WriteError,
    io::bvh::BvhError, io::gltf::PosingError, io::gltf::SceneError, io::gltf::UnwritableScene,
    io::rig::RigPosingError, kinematics::CentreOfMassError, kinematics::KinematicsError,
    model::MassError, skinning::VolumeError, mesh::MeshError, model::ModelError,
    model::UnknownName, problem::ProblemError, robot::ToolError, robot::RobotFileError,
    skeleton::SkeletonError, skinning::AutomaticWeightsError, skinning::BlendShapesError,
    skinning::CageError, skinning::MorphError, skinning::SkinningError,
    skinning::UnknownSkinning, skinning::WeightsError, spatial::NotRigid,
    spatial::RigidDefect,
}

#[test]
fn methods_and_deformations_may_be_boxed_and_sent() {
    fn sent<T: Send + ?Sized>() {}
    sent::<dyn solver::AnyMethod>();
    sent::<Box<dyn skinning::Deformation + Send>>();
}
