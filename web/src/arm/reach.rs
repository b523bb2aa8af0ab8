//! Reachability, goal sets and self-motions of an arm.

use js_sys::{Array, Float64Array};
use kinopt::arm::{GoalSet, GoalSetSolution, SelfMotion};
use kinopt::spatial::Placement;
use kinopt_bindings::goal_set;
use wasm_bindgen::prelude::*;

use super::Arm;
use crate::error::{Exception, raise};
use crate::object;
use crate::placement::{read, read_all};
use crate::solution::Solution;

/// Largest number of boxes of a proof, by default.
const MAX_BOXES: u32 = 20_000;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Answer to whether a target can be reached: a configuration, or a proof that there is none. */
export interface Reachability {
    /** True if `solution` reaches the target, false if no configuration within the joint limits does; undefined if
     * undecided. */
    readonly reachable?: boolean;
    /** The solution, or the closest pose found. */
    readonly solution: Solution;
    /** Number of boxes of joint values that were examined; 0 for a reachable target. */
    readonly boxes: number;
}

/** Result of a goal set: lists with an entry for each tool. */
export interface GoalSetSolution {
    /** Results of each tool, one a target; "out of reach" is proven. */
    readonly status: readonly (readonly ("reached" | "in collision" | "out of reach" | "missed")[])[];
    /** Costs of each tool, one a target; infinite unless the target is reached. Manipulability and clearance are
     * negative costs. */
    readonly cost: readonly Float64Array[];
    /** Configurations of each tool, one after another, radians or metres: the closest one found if a target is not
     * reached, NaN if it is out of reach. */
    readonly q: readonly Float64Array[];
    /** Indices of tool and target of all reached targets, best first. */
    readonly ranking: readonly (readonly [tool: number, target: number])[];
}

/** A curve of configurations that keep the tool at its target. */
export interface SelfMotion {
    /** Successive configurations, seven numbers each, radians. */
    readonly q: Float64Array;
    /** True if the last configuration is followed by the first. */
    readonly closed: boolean;
}
"#;

#[wasm_bindgen]
impl Arm {
    /// Decides whether any configuration within the joint limits reaches a target: by a solution, or by a proof with up
    /// to `maxBoxes` boxes of joint values (default 20000).
    #[wasm_bindgen(unchecked_return_type = "Reachability")]
    pub fn reachability(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Placement")] target: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] start: JsValue,
        #[wasm_bindgen(js_name = maxBoxes, unchecked_optional_param_type = "number")]
        max_boxes: Option<u32>,
    ) -> Result<JsValue, Exception> {
        let target = read(target, "target")?;
        let start = self.start(start)?;
        let max_boxes = max_boxes.unwrap_or(MAX_BOXES) as usize;
        let answer = self.inner.reachability(target, &start, max_boxes);
        let answer = answer.map_err(raise)?;
        let object = object::of([
            ("reachable", answer.is_reachable().into()),
            ("boxes", (answer.boxes() as f64).into()),
            ("solution", Solution::from(answer.into_solution()).into()),
        ]);
        Ok(object.into())
    }

    /// Solves every target for each tool, and ranks the reached ones.
    ///
    /// `targets` and `tools` are matrices in one list, sixteen numbers each; a tool is a placement in the tip. Without
    /// `tools` it is the arm's tool. `criterion` is "distance" from `start` (default), "manipulability" or "clearance".
    /// Targets that are easily proven to be out of reach are not searched for.
    #[wasm_bindgen(js_name = solveGoals, unchecked_return_type = "GoalSetSolution")]
    pub fn solve_goals(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] targets: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] tools: Option<Vec<f64>>,
        #[wasm_bindgen(
            unchecked_optional_param_type = "'distance' | 'manipulability' | 'clearance'"
        )]
        criterion: Option<String>,
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] start: JsValue,
    ) -> Result<JsValue, Exception> {
        let targets: Vec<Placement<f64>> = read_all(targets, "target")?;
        let set = match tools {
            Some(tools) => GoalSet::of_tools(&self.inner, &read_all(&tools, "tool")?),
            None => Ok(GoalSet::new([kinopt::Arm::clone(&self.inner)])),
        };
        let set = set.map_err(raise)?;
        let criterion = goal_set::criterion(criterion.as_deref().unwrap_or("distance"));
        let criterion = criterion.map_err(raise)?;
        let starts = vec![self.start(start)?; set.arms().len()];
        let solution = set.solve(&targets, &starts, criterion).map_err(raise)?;
        Ok(goal_set_object(&solution))
    }

    /// Samples the self-motions of seven revolute joints: all curves of configurations that keep the tool at a target.
    /// Successive configurations differ by at most 0.05 rad in every joint. Undefined for other arms.
    #[wasm_bindgen(js_name = selfMotions, unchecked_return_type = "SelfMotion[] | undefined")]
    pub fn self_motions(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Placement")] target: &[f64],
    ) -> Result<JsValue, Exception> {
        let target = read(target, "target")?;
        let motions = self.inner.self_motions(target).map_err(raise)?;
        let list = |motions: Vec<SelfMotion>| motions.iter().map(self_motion).collect::<Array>();
        Ok(motions.map(list).into())
    }
}

fn goal_set_object(solution: &GoalSetSolution) -> JsValue {
    let rows = solution.outcomes.iter();
    let status = rows.map(|row| {
        let names = row.iter().map(|outcome| goal_set::status(outcome.status));
        names.map(JsValue::from).collect::<Array>()
    });
    let rows = solution.outcomes.iter();
    let cost = rows.map(|row| {
        let costs: Vec<f64> = row.iter().map(|outcome| outcome.cost).collect();
        Float64Array::from(&*costs)
    });
    let q = solution.q.iter().map(|q| Float64Array::from(&**q));
    let ranking = solution.ranking().into_iter().map(|(tool, target)| {
        let pair = [tool, target].map(|index| JsValue::from(index as f64));
        pair.into_iter().collect::<Array>()
    });
    let object = object::of([
        ("status", status.collect::<Array>().into()),
        ("cost", cost.collect::<Array>().into()),
        ("q", q.collect::<Array>().into()),
        ("ranking", ranking.collect::<Array>().into()),
    ]);
    object.into()
}

fn self_motion(motion: &SelfMotion) -> JsValue {
    let object = object::of([
        ("q", Float64Array::from(&*motion.q).into()),
        ("closed", motion.closed.into()),
    ]);
    object.into()
}
