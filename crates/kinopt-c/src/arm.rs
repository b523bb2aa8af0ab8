//! Arms: construction, limits, forward kinematics, single queries.

use std::ffi::{CString, c_char, c_void};
use std::sync::Arc;
use std::time::Duration;

use kinopt::Arm;
use kinopt::arm::Base;
use kinopt_bindings::option::arm::{OBJECTS, apply, options};
use kinopt_bindings::option::names;

use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::robot::KinoptRobot;
use crate::settings::settings;
use crate::solution::KinoptSolution;
use crate::world::{KinoptCollisionModel, KinoptWorld};

/// An arm: the joints from a base to a tip of a robot, prepared for queries. It is immutable.
pub struct KinoptArm {
    pub(crate) inner: Arc<Arm>,
    joints: Vec<CString>,
}

impl KinoptArm {
    fn new(arm: Arm) -> Self {
        Self {
            joints: arm.joints().map(pointer::kept_text).collect(),
            inner: Arc::new(arm),
        }
    }
}

/// Options of an arm that are arguments of functions here, or missing.
const ELSEWHERE: [(&str, &str); 4] = [
    ("world", "pass it to kinopt_arm_new_in_world"),
    ("margin", "pass it to kinopt_arm_new_in_world"),
    ("collision_model", "pass it to kinopt_arm_new_in_world"),
    (
        "srdf",
        "the C interface has no SRDF; pass a start to each query",
    ),
];

unsafe fn built(
    robot: *const KinoptRobot,
    base: *const c_char,
    tip: *const c_char,
    text: *const c_char,
) -> Result<Arm, Failure> {
    let mut known = names(&options());
    known.retain(|name| !OBJECTS.contains(name));
    // SAFETY: by the contract of the caller.
    let (robot, base, tip, settings) = unsafe {
        (
            &pointer::object(robot, "robot")?.inner,
            pointer::optional_text(base, "base")?,
            pointer::text(tip, "tip")?,
            settings(text, "option of an arm", &known, &ELSEWHERE)?,
        )
    };
    let base = base.map_or(Base::World, Base::from);
    let builder = Arm::builder(&**robot, base, tip);
    let builder = apply(builder, &settings, robot.model()).map_err(of_json)?;
    if settings.contains_key("held") && !settings.contains_key("only") {
        return Err(Failure::invalid(
            "`held` needs `only`: it is the configuration of the joints that `only` omits; positions of joints outside \
             the arm are the argument `held` of kinopt_arm_new_in_world"
                .to_owned(),
        ));
    }
    Ok(builder.build()?)
}

/// Creates the arm from the frame `base` to the frame `tip`; base null is the world.
///
/// `settings` are the options of arms of `docs/reference/options.md`: `position_tolerance`, `orientation_tolerance`, `goal`
/// ("pose", "position" or six half widths), `search` ("start", "first", "nearest"), `time_limit`, `seed`, `posture`,
/// `max_move`, `locked`, `only`, `tool` (four rows of four numbers), and others.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_new(
    robot: *const KinoptRobot,
    base: *const c_char,
    tip: *const c_char,
    settings: *const c_char,
    arm: *mut *mut KinoptArm,
) -> KinoptStatus {
    guard(|| unsafe {
        let built = built(robot, base, tip, settings)?;
        pointer::give(arm, KinoptArm::new(built), "arm")
    })
}

/// Creates an arm that avoids collisions of the robot with itself and with a world, by at least `margin` metres.
///
/// The world is copied. `held` has the positions of the joints outside the arm, a configuration of the robot; null for the
/// neutral one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_new_in_world(
    robot: *const KinoptRobot,
    base: *const c_char,
    tip: *const c_char,
    collision_model: *const KinoptCollisionModel,
    world: *const KinoptWorld,
    margin: f64,
    held: *const f64,
    held_length: usize,
    settings: *const c_char,
    arm: *mut *mut KinoptArm,
) -> KinoptStatus {
    guard(|| unsafe {
        let built = built(robot, base, tip, settings)?;
        let model = pointer::object(collision_model, "collision_model")?;
        let checker = model.checker(pointer::object(world, "world")?, margin)?;
        let held = match pointer::optional_array(held, held_length, "held")? {
            Some(held) => held.to_vec(),
            None => checker.model().model().neutral(),
        };
        let built = built.with_checker(&checker, &held)?;
        pointer::give(arm, KinoptArm::new(built), "arm")
    })
}

/// Creates the arm with another world, which is copied. The arm already avoids collisions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_with_world(
    arm: *const KinoptArm,
    world: *const KinoptWorld,
    margin: f64,
    changed: *mut *mut KinoptArm,
) -> KinoptStatus {
    guard(|| unsafe {
        let world = &pointer::object(world, "world")?.inner;
        let other = (pointer::object(arm, "arm")?.inner).with_world(world, Some(margin))?;
        pointer::give(changed, KinoptArm::new(other), "changed")
    })
}

/// Creates the arm with another tool, a placement in the tip's frame. The seed table is shared, so this is fast.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_with_tool(
    arm: *const KinoptArm,
    tip_from_tool: *const f64,
    changed: *mut *mut KinoptArm,
) -> KinoptStatus {
    guard(|| unsafe {
        let tool = pointer::placement(tip_from_tool, "tip_from_tool")?;
        let other = (pointer::object(arm, "arm")?.inner).with_tool(tool)?;
        pointer::give(changed, KinoptArm::new(other), "changed")
    })
}

/// Creates the arm with other bounds of a query: a time limit in seconds (infinite for none), and the largest motion of
/// each joint from the start (null for none). The seed table is shared, so this is fast.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_with_bounds(
    arm: *const KinoptArm,
    time_limit: f64,
    max_move: *const f64,
    max_move_length: usize,
    changed: *mut *mut KinoptArm,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let max_move = pointer::optional_array(max_move, max_move_length, "max_move")?;
        let limit = match time_limit == f64::INFINITY {
            true => None,
            false => Some(Duration::try_from_secs_f64(time_limit).map_err(|_| {
                Failure::invalid(format!(
                    "`time_limit` is {time_limit}, expected seconds of at least 0"
                ))
            })?),
        };
        let other = arm.with_query_bounds(limit, max_move)?;
        pointer::give(changed, KinoptArm::new(other), "changed")
    })
}

/// Frees an arm.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_free(arm: *mut KinoptArm) {
    unsafe { pointer::free(arm) }
}

/// Number of joints, the length of a configuration; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_joint_count(arm: *const KinoptArm) -> usize {
    let arm = unsafe { pointer::object(arm, "arm") };
    arm.map_or(0, |arm| arm.joints.len())
}

/// Name of a joint, from base to tip, valid as long as the arm; null for an index out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_joint_name(
    arm: *const KinoptArm,
    index: usize,
) -> *const c_char {
    let arm = unsafe { pointer::object(arm, "arm") };
    pointer::text_at(arm.map_or(&[], |arm| &arm.joints), index)
}

/// Writes the position limits of the joints, radians or metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_limits(
    arm: *const KinoptArm,
    lower: *mut f64,
    upper: *mut f64,
    length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let limits = pointer::object(arm, "arm")?.inner.limits();
        let (lowest, highest): (Vec<f64>, Vec<f64>) =
            limits.map(|limits| (limits.lower, limits.upper)).unzip();
        pointer::copy(&lowest, lower, length, "lower")?;
        pointer::copy(&highest, upper, length, "upper")
    })
}

/// Writes the default start: the middle of the limits, or the value closest to 0 for a joint without limits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_default_start(
    arm: *const KinoptArm,
    q: *mut f64,
    q_length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        pointer::copy(arm.default_start(), q, q_length, "q")
    })
}

/// Writes the placement of the tool in the base at a configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_base_from_tool(
    arm: *const KinoptArm,
    q: *const f64,
    q_length: usize,
    base_from_tool: *mut f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let placement = arm.base_from_tool(pointer::array(q, q_length, "q")?)?;
        pointer::write_placement(&placement, base_from_tool, "base_from_tool")
    })
}

/// Writes whether a configuration of an arm that avoids collisions has pairs in collision, or nearer than its margin.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_collides(
    arm: *const KinoptArm,
    q: *const f64,
    q_length: usize,
    collides: *mut bool,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let collisions = arm.collisions(pointer::array(q, q_length, "q")?)?;
        pointer::write(collides, !collisions.is_empty(), "collides")
    })
}

/// Solves for one target of the tool in the base, from a start configuration.
///
/// `base_from_tool` is a placement. A target that is not reached is no error: see `kinopt_solution_reached` and
/// `kinopt_solution_explain`. A solution can be used again, which avoids allocations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_solve(
    arm: *const KinoptArm,
    base_from_tool: *const f64,
    start: *const f64,
    start_length: usize,
    solution: *mut KinoptSolution,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let target = pointer::placement(base_from_tool, "base_from_tool")?;
        let start = pointer::array(start, start_length, "start")?;
        let solution = &mut pointer::object_mut(solution, "solution")?.inner;
        Ok(arm.solve_into(target, start, solution)?)
    })
}

/// Returns true to accept a configuration of an arm. It must not throw.
pub type KinoptAccept =
    Option<unsafe extern "C" fn(q: *const f64, q_length: usize, user_data: *mut c_void) -> bool>;

/// Solves for one target, and offers reached configurations to a callback until it accepts one.
///
/// The first is that of `kinopt_arm_solve`, then come further ones that differ by 0.1 rad, nearest to the start first. An arm
/// with a time limit searches until it ends, at last for solutions that differ by 0.001 rad, or until further attempts lead to
/// no new solution. `accepted` is false, and the solution is the first one, if the callback rejects all of them or the target
/// is not reached.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_solve_accepted(
    arm: *const KinoptArm,
    base_from_tool: *const f64,
    start: *const f64,
    start_length: usize,
    accept: KinoptAccept,
    user_data: *mut c_void,
    solution: *mut KinoptSolution,
    accepted: *mut bool,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let target = pointer::placement(base_from_tool, "base_from_tool")?;
        let start = pointer::array(start, start_length, "start")?;
        let accept = accept.ok_or_else(|| Failure::invalid("`accept` is null".to_owned()))?;
        let solution = &mut pointer::object_mut(solution, "solution")?.inner;
        pointer::write(accepted, false, "accepted")?;
        let accepts = |q: &[f64]| accept(q.as_ptr(), q.len(), user_data);
        let found = arm.solve_accepted(target, start, accepts, solution)?;
        pointer::write(accepted, found, "accepted")
    })
}

/// Finds all solutions of one target, nearest to the start first.
///
/// For six revolute joints and a full pose the set is complete: all isolated solutions within the limits, with whole
/// turns. `complete` then becomes true. Other arms return the solutions that their attempts find.
///
/// Writes up to `capacity` configurations to `q`, one after another. `count` becomes the number of solutions, which may
/// exceed the capacity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_solve_all(
    arm: *const KinoptArm,
    base_from_tool: *const f64,
    start: *const f64,
    start_length: usize,
    q: *mut f64,
    capacity: usize,
    count: *mut usize,
    complete: *mut bool,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let target = pointer::placement(base_from_tool, "base_from_tool")?;
        let start = pointer::array(start, start_length, "start")?;
        let length = capacity.checked_mul(arm.joint_count());
        let length = length.ok_or_else(|| {
            Failure::invalid(format!("the capacity {capacity} of `q` is not possible"))
        })?;
        let q = pointer::array_mut(q, length, "q")?;
        let all = arm.solve_all_from(target, start)?;
        for (row, solution) in q.chunks_mut(arm.joint_count().max(1)).zip(&all.solutions) {
            row.copy_from_slice(&solution.q);
        }
        pointer::write(complete, all.complete, "complete")?;
        pointer::write(count, all.solutions.len(), "count")
    })
}
