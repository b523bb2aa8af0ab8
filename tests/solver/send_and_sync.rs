//! Promise: everything that is built once can be shared between threads, and everything a caller
//! owns can be sent to another.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::animation::{Armature, Clip, Cursor, Pose, ReachLayer, StateMachine, StateMachineRun};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{ModelError, ParameterMap};
use kinopt::problem::{ProblemError, Scratch};
use kinopt::scalar::Dual;
use kinopt::skeleton::{Posing, SkeletonError};
use kinopt::skinning::{
    CageBinding, CageError, Deformation, MorphError, MorphTargets, PackedDualQuaternionBlend,
    PackedLinearBlend, SkinWeights, SkinningError, WeightsError,
};
use kinopt::solver::{Memory, Method};
use kinopt::{Model, Problem, Skeleton, Solution, Solver, Workspace};

const fn shared<T: Send + Sync + ?Sized>() {}
const fn static_error<T: std::error::Error + Send + Sync + 'static>() {}

const _: () = {
    shared::<Model>();
    shared::<ParameterMap>();
    shared::<Skeleton>();
    shared::<Problem>();
    shared::<Solver>();
    shared::<dyn Method>();
    shared::<Workspace>();
    shared::<Scratch>();
    shared::<Memory>();
    shared::<Solution>();
    shared::<Posing>();
    shared::<Armature>();
    shared::<Clip>();
    shared::<Cursor>();
    shared::<Pose>();
    shared::<ReachLayer>();
    shared::<StateMachine>();
    shared::<StateMachineRun>();
    shared::<ForwardKinematics>();
    shared::<ForwardKinematics<Dual<6>>>();
    shared::<SkinWeights>();
    shared::<PackedLinearBlend<'static>>();
    shared::<PackedDualQuaternionBlend<'static>>();
    shared::<MorphTargets>();
    shared::<CageBinding>();
    shared::<dyn Deformation + Send>();
    static_error::<SkinningError>();
    static_error::<WeightsError>();
    static_error::<MorphError>();
    static_error::<CageError>();
    static_error::<ModelError>();
    static_error::<ProblemError>();
    static_error::<SkeletonError>();
    static_error::<kinopt::ik::SolveError>();
    static_error::<kinopt::model::UnknownName>();
};

#[test]
fn a_solver_crosses_threads() {
    let solver = Solver::default();
    let name = std::thread::spawn(move || solver.method()).join().unwrap();
    assert_eq!(name, "levenberg-marquardt");
}
