//! All solutions of a target as plain objects.

use js_sys::{Array, Float64Array};
use kinopt::arm::{AllSolutions, PoseSolution};
use kinopt_bindings::names::{argument, elbow, shoulder, wrist};
use wasm_bindgen::prelude::*;

use crate::object;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** A solution of a set. */
export interface PoseSolution {
    /** Joint positions, base to tip, radians or metres. */
    readonly q: Float64Array;
    /** Metres. */
    readonly positionError: number;
    /** Radians. */
    readonly orientationError: number;
    /** Branches; undefined where the structure of the arm defines none. */
    readonly shoulder?: "left" | "right";
    readonly elbow?: "up" | "down";
    readonly wrist?: "no_flip" | "flip";
}

/** Solutions of a target, nearest to the start first. */
export interface AllSolutions {
    readonly solutions: readonly PoseSolution[];
    /** True if the set has all isolated solutions, and there are no others. */
    readonly complete: boolean;
    /** True if the target has a continuous family of solutions, of which the set has samples. */
    readonly hasFamily: boolean;
    /** Argument for the completeness. */
    readonly argument?: "spherical_wrist" | "spherical_shoulder" | "three_parallel_axes" | "univariate_polynomial";
}
"#;

/// Creates the object of a set.
pub(super) fn of(all: &AllSolutions) -> JsValue {
    let solutions: Array = all.solutions.iter().map(solution).collect();
    let object = object::of([
        ("solutions", solutions.into()),
        ("complete", all.complete.into()),
        ("hasFamily", all.has_family.into()),
        ("argument", argument(&all.argument).into()),
    ]);
    object.into()
}

fn solution(solution: &PoseSolution) -> JsValue {
    let branch = &solution.branch;
    let object = object::of([
        ("q", Float64Array::from(&*solution.q).into()),
        ("positionError", solution.position_error.into()),
        ("orientationError", solution.orientation_error.into()),
        ("shoulder", branch.shoulder.map(shoulder).into()),
        ("elbow", branch.elbow.map(elbow).into()),
        ("wrist", branch.wrist.map(wrist).into()),
    ]);
    object.into()
}
