//! Names of JavaScript, and types of TypeScript.

use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const NUMBERS: &str = r#"
/** Numbers: a typed array (copied as one block) or an array. */
export type Numbers = ArrayLike<number>;

/** A placement: a 4 x 4 matrix by columns, as three.js's `Matrix4.elements`; metres (a rig's own unit for rigs). */
export type Placement = ArrayLike<number>;
"#;

/// Converts a message to camel-case options: `option position_tolerance is -1` becomes `option positionTolerance is
/// -1`.
pub(crate) fn of_javascript(text: &str) -> String {
    let mut previous = "";
    let word = |word| {
        let is_option =
            std::mem::replace(&mut previous, word) == "option" || OPTIONS.contains(&word);
        if is_option {
            camel(word)
        } else {
            word.to_owned()
        }
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// Options that messages also begin with, as in `joint_weights has 2 numbers`.
const OPTIONS: [&str; 4] = [
    "joint_weights",
    "max_move",
    "mimic_limits",
    "velocity_limits",
];

/// Converts a name in words or in snake case to camel case.
pub(crate) fn camel(name: &str) -> String {
    let mut upper = false;
    let letter = |letter: char| {
        let is_gap = matches!(letter, '_' | ' ' | '-');
        let capital = std::mem::replace(&mut upper, is_gap);
        match (is_gap, capital) {
            (true, _) => None,
            (false, true) => Some(letter.to_ascii_uppercase()),
            (false, false) => Some(letter),
        }
    };
    name.chars().filter_map(letter).collect()
}
