//! Number of cases of a test: a slower debug build checks fewer unless `KINOPT_CASES` is set.

/// Number of cases: the first number in a release build, the second in a debug build, or `KINOPT_CASES`.
pub fn cases(release: usize, debug: usize) -> usize {
    let requested = std::env::var("KINOPT_CASES").ok();
    let usual = if cfg!(debug_assertions) {
        debug
    } else {
        release
    };
    requested.map_or(usual, |count| count.parse().unwrap())
}

/// True if a test checks only a part of its cases: in a debug build, unless `KINOPT_CASES` is set.
pub fn few() -> bool {
    cfg!(debug_assertions) && std::env::var_os("KINOPT_CASES").is_none()
}

/// All items, or every `every`-th item in a debug build.
pub fn part<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if few() { every } else { 1 })
}
