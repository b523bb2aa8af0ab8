//! Results of a solve.

use js_sys::Array;
use wasm_bindgen::prelude::*;

use crate::object;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** An active limit. */
export interface ActiveLimit {
    joint: string;
    side: "lower" | "upper";
    /** Radians or metres. */
    value: number;
    /** Decrease of the cost per unit beyond the limit. */
    push: number;
}

/** Report of a task. */
export interface TaskReport {
    name: string;
    reached: boolean;
    /** Metres; missing if the task has no position. */
    positionError?: number;
    /** Radians; missing if the task has no orientation. */
    orientationError?: number;
}

/** A pair that is in contact, nearer than the margin, or blocks a motion. */
export interface Collision {
    first: string;
    firstKind: "link" | "obstacle";
    second: string;
    secondKind: "link" | "obstacle";
    /** Metres; negative for penetration. */
    distance: number;
    /**
     * True if the pair blocks the motion to a configuration. A step, or a part of it, was not made, because it is not
     * proven collision-free. `distance` is that at the end of the motion, up to a micrometre more than the margin.
     */
    onTheWay: boolean;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Limits as objects.
    #[wasm_bindgen(typescript_type = "ActiveLimit[]")]
    pub type ActiveLimits;
    /// Tasks as objects.
    #[wasm_bindgen(typescript_type = "TaskReport[]")]
    pub type TaskReports;
    /// Collisions as objects.
    #[wasm_bindgen(typescript_type = "Collision[]")]
    pub type Collisions;
}

/// Solution: a configuration, its errors, and the limits and collisions that prevent better ones.
#[wasm_bindgen]
pub struct Solution {
    inner: kinopt::Solution,
}

impl From<kinopt::Solution> for Solution {
    fn from(inner: kinopt::Solution) -> Self {
        Self { inner }
    }
}

#[wasm_bindgen]
impl Solution {
    /// Configuration, radians and metres.
    #[wasm_bindgen(getter)]
    pub fn q(&self) -> Vec<f64> {
        self.inner.q.clone()
    }

    /// True if every required task is within its tolerance, and the configuration is collision-free.
    #[wasm_bindgen(getter)]
    pub fn reached(&self) -> bool {
        self.inner.reached
    }

    /// True if every required task is within its tolerance, even in collision.
    #[wasm_bindgen(getter, js_name = goalsReached)]
    pub fn goals_reached(&self) -> bool {
        self.inner.goals_reached()
    }

    /// Largest position error, metres.
    #[wasm_bindgen(getter, js_name = positionError)]
    pub fn position_error(&self) -> Option<f64> {
        self.inner.position_error()
    }

    /// Largest orientation error, radians.
    #[wasm_bindgen(getter, js_name = orientationError)]
    pub fn orientation_error(&self) -> Option<f64> {
        self.inner.orientation_error()
    }

    /// Name of the test that ended the search.
    #[wasm_bindgen(getter)]
    pub fn termination(&self) -> String {
        self.inner.termination.name().to_owned()
    }

    /// Iterations of all attempts.
    #[wasm_bindgen(getter)]
    pub fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// Number of attempts.
    #[wasm_bindgen(getter)]
    pub fn attempts(&self) -> usize {
        self.inner.attempts
    }

    /// True if a missed target is proven unreachable.
    #[wasm_bindgen(getter, js_name = isOutOfReach)]
    pub fn is_out_of_reach(&self) -> bool {
        self.inner.is_out_of_reach()
    }

    /// Active limits.
    #[wasm_bindgen(getter, js_name = activeLimits)]
    pub fn active_limits(&self) -> ActiveLimits {
        let limits = self.inner.active_limits().map(|limit| {
            object::of([
                ("joint", limit.joint.into()),
                ("side", format!("{:?}", limit.side).to_lowercase().into()),
                ("value", limit.value.into()),
                ("push", limit.push.into()),
            ])
        });
        limits.collect::<Array>().unchecked_into()
    }

    /// Reports of the tasks.
    #[wasm_bindgen(getter)]
    pub fn tasks(&self) -> TaskReports {
        let or_none = |error: Option<f64>| error.map_or(JsValue::UNDEFINED, JsValue::from);
        let tasks = self.inner.tasks().map(|task| {
            object::of([
                ("name", task.name.into()),
                ("reached", task.reached.into()),
                ("positionError", or_none(task.position_error())),
                ("orientationError", or_none(task.orientation_error())),
            ])
        });
        tasks.collect::<Array>().unchecked_into()
    }

    /// Summary as a text.
    pub fn explain(&self) -> String {
        self.inner.explain()
    }
}

#[cfg(feature = "collision")]
#[wasm_bindgen]
impl Solution {
    /// Pairs in collision at the solution, or the pair that blocks the step to a better one.
    #[wasm_bindgen(getter)]
    pub fn collisions(&self) -> Collisions {
        collisions(self.inner.collisions())
    }
}

/// Collisions as objects.
#[cfg(feature = "collision")]
pub(crate) fn collisions(collisions: &[kinopt::ik::Collision]) -> Collisions {
    let objects = collisions.iter().map(|pair| object::of(fields(pair)));
    objects.collect::<Array>().unchecked_into()
}

/// Fields of the object of a collision.
#[cfg(any(feature = "collision", feature = "paths"))]
pub(crate) fn fields(pair: &kinopt::ik::Collision) -> [(&'static str, JsValue); 6] {
    [
        ("first", pair.first.as_str().into()),
        ("firstKind", pair.first_kind.name().into()),
        ("second", pair.second.as_str().into()),
        ("secondKind", pair.second_kind.name().into()),
        ("distance", pair.distance.into()),
        ("onTheWay", pair.on_the_way.into()),
    ]
}
