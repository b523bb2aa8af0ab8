//! Drags: one problem with moving targets, solved in every frame.

use kinopt_bindings::task::Aimed;
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::model::Model;
use crate::problem::{Problem, TargetsByName};
use crate::solution::Solution;

/// Solves a problem repeatedly while its targets move, such as a hand dragged by a mouse. Each frame continues from the
/// last on the same branch, in a bounded number of iterations. No joint moves farther in a frame than `maxMove`.
#[wasm_bindgen]
pub struct Drag {
    problem: Problem,
    inner: kinopt::ik::Drag,
}

#[wasm_bindgen]
impl Drag {
    /// Starts a drag of `problem` at the configuration `start` of its model, clamped into the limits. `maxMove` is the
    /// largest displacement of a joint per frame, radians; default 0.15. Prismatic joints have an equivalent length.
    #[wasm_bindgen(constructor)]
    pub fn new(
        problem: &Problem,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] start: &[f64],
        #[wasm_bindgen(js_name = maxMove)] max_move: Option<f64>,
    ) -> Result<Self, Exception> {
        let mut inner = kinopt::ik::Drag::new(problem.inner.clone(), start).map_err(raise)?;
        if let Some(radians) = max_move {
            inner = inner.with_max_move(radians).map_err(raise)?;
        }
        Ok(Self {
            problem: problem.clone(),
            inner,
        })
    }

    /// Enables motion limits in every frame; frames are `timeStep` seconds apart. The limits of velocity (rad/s or
    /// m/s), acceleration (rad/s² or m/s²) and jerk (rad/s³ or m/s³) are lists. Each has one number for each number of
    /// a configuration. `undefined` is no limit. The drag then starts at rest.
    #[wasm_bindgen(js_name = limitMotion)]
    pub fn limit_motion(
        &mut self,
        #[wasm_bindgen(js_name = timeStep)] time_step: f64,
        #[wasm_bindgen(js_name = velocityLimits)] velocity: Option<Vec<f64>>,
        #[wasm_bindgen(js_name = accelerationLimits)] acceleration: Option<Vec<f64>>,
        #[wasm_bindgen(js_name = jerkLimits)] jerk: Option<Vec<f64>>,
    ) -> Result<(), Exception> {
        let numbers = self.inner.q().len();
        let mut limits = kinopt::ik::MotionLimits::unlimited(numbers);
        for (limit, values) in [
            (&mut limits.velocity, velocity),
            (&mut limits.acceleration, acceleration),
            (&mut limits.jerk, jerk),
        ] {
            if let Some(values) = values {
                *limit = values;
            }
        }
        let limited = self.inner.clone().with_motion_limits(time_step, &limits);
        self.inner = limited.map_err(raise)?;
        Ok(())
    }

    /// Moves targets without computing a frame. Keys are names of tasks, as in `{ left_hand: [0.4, 0.1, 0.3] }`.
    #[wasm_bindgen(js_name = setTargets)]
    pub fn set_targets(&mut self, targets: TargetsByName) -> Result<(), Exception> {
        let mut aimed = Aimed::Drag(&mut self.inner);
        self.problem.aim(&mut aimed, Some(targets))
    }

    /// Computes one frame, after moving the given targets as in `setTargets`. Other targets stay.
    pub fn advance(&mut self, targets: Option<TargetsByName>) -> Result<Solution, Exception> {
        self.problem
            .aim(&mut Aimed::Drag(&mut self.inner), targets)?;
        Ok(self.inner.advance().clone().into())
    }

    /// Computes frames until the targets are reached and no joint is limited by `maxMove`, or until the drag is at
    /// rest. The largest number of frames is `frames`, by default 1000.
    pub fn follow(
        &mut self,
        targets: Option<TargetsByName>,
        frames: Option<u32>,
    ) -> Result<Solution, Exception> {
        self.problem
            .aim(&mut Aimed::Drag(&mut self.inner), targets)?;
        let frames = at_least_one(frames)?;
        Ok(self.inner.follow(frames).clone().into())
    }

    /// Moves to the targets until the drag is at rest on its branch, for a single pose or distant targets. It takes at
    /// most `frames` frames per motion, by default 1000.
    pub fn settle(
        &mut self,
        targets: Option<TargetsByName>,
        frames: Option<u32>,
    ) -> Result<Solution, Exception> {
        self.problem
            .aim(&mut Aimed::Drag(&mut self.inner), targets)?;
        let frames = at_least_one(frames)?;
        Ok(self.inner.settle(frames).clone().into())
    }

    /// Continues from another configuration, clamped into the limits.
    #[wasm_bindgen(js_name = setConfiguration)]
    pub fn set_configuration(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<(), Exception> {
        self.inner.set_configuration(q).map_err(raise)
    }

    /// Replaces the placements of joints and frames on their parents by those of `model`, which has the joints and
    /// frames of the problem's model. The configuration stays. For a character whose scales shear its bones, call it
    /// after each frame with `skeleton.standingIn(pose).model`.
    #[wasm_bindgen(js_name = moveJoints)]
    pub fn move_joints(&mut self, model: &Model) -> Result<(), Exception> {
        self.inner.move_joints(&model.inner).map_err(raise)
    }

    /// Current configuration of the problem's model, radians and metres.
    #[wasm_bindgen(getter)]
    pub fn q(&self) -> Vec<f64> {
        self.inner.q().to_vec()
    }

    /// True if a joint moved as far as a frame allows, and has not arrived. The next frames continue the motion.
    #[wasm_bindgen(getter, js_name = isSpeedLimited)]
    pub fn is_speed_limited(&self) -> bool {
        self.inner.is_speed_limited()
    }

    /// True if the next frame would change nothing.
    #[wasm_bindgen(getter, js_name = isAtRest)]
    pub fn is_at_rest(&self) -> bool {
        self.inner.is_at_rest()
    }
}

fn at_least_one(frames: Option<u32>) -> Result<usize, Exception> {
    match frames.unwrap_or(1000) {
        0 => Err(Exception::new("frames is 0, expected at least 1")),
        frames => Ok(frames as usize),
    }
}
