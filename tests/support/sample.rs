//! How much a test looks at: a debug build, which is some times slower, looks at a part
//! unless `KINOPT_CASES` is set.

/// How many cases of something: fewer in a debug build, and as many as `KINOPT_CASES` asks for.
pub fn cases(release: usize, debug: usize) -> usize {
    let asked = std::env::var("KINOPT_CASES").ok();
    let usual = if cfg!(debug_assertions) {
        debug
    } else {
        release
    };
    asked.map_or(usual, |count| count.parse().unwrap())
}

/// Whether a test looks at less than all: in a debug build, unless `KINOPT_CASES` is set.
pub fn few() -> bool {
    cfg!(debug_assertions) && std::env::var_os("KINOPT_CASES").is_none()
}

/// Of what a test goes through, all, or every `every`-th in a debug build.
pub fn part<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if few() { every } else { 1 })
}
