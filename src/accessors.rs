//! Functions of one shape, a line each: what reads a value's part, and what sets it on the way.

/// What reads a part: `pub fn rows(&self) -> usize = self.rows;`.
macro_rules! getters {
    ($($(#[$about:meta])* $vis:vis fn $name:ident($($own:tt)+) -> $part:ty = $value:expr;)+) => {
        $($(#[$about])* #[must_use] $vis fn $name($($own)+) -> $part { $value })+
    };
}

/// What sets a part of what is being made: `pub fn with_seed(mut self, seed: u64) { self.seed = seed }`.
macro_rules! setters {
    ($($(#[$about:meta])* $vis:vis fn $name:ident(mut $own:ident $(, $given:ident: $kind:ty)*) $set:block)+) => {
        $($(#[$about])* #[must_use] $vis fn $name(mut $own $(, $given: $kind)*) -> Self { $set; $own })+
    };
}
