//! Types that only TypeScript sees.

use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const NUMBERS: &str = r#"
/** Numbers in, in a typed array (copied as one block) or any list. */
export type Numbers = ArrayLike<number>;

/** A placement: a 4 x 4 matrix by columns, as three.js's `Matrix4.elements`; metres (a rig's own unit for rigs). */
export type Placement = ArrayLike<number>;
"#;
