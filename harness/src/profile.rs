//! Curves that compare solvers over several problems.

/// The performance profile of Dolan & Moré 2002, "Benchmarking optimization software with performance profiles": for
/// each solver s the fraction of problems p that it solves within τ times the time of the fastest, ρ_s(τ) = |{p : t_ps
/// / min_s t_ps ≤ τ}| / |P|.
///
/// `times` has a list for each solver with one entry for each problem: any positive measure of cost, `None` if the
/// problem was not solved. The points of each curve are (τ, ρ) by ascending τ ≥ 1; ρ is constant between points.
/// Problems that no solver solves count in |P|.
#[must_use]
pub fn performance_profile(times: &[Vec<Option<f64>>]) -> Vec<Vec<(f64, f64)>> {
    let problems = times.iter().map(Vec::len).max().unwrap_or(0);
    let fastest: Vec<f64> = (0..problems)
        .map(|problem| {
            let solved = times
                .iter()
                .filter_map(|solver_times| solver_times.get(problem).copied().flatten());
            solved.fold(f64::INFINITY, f64::min)
        })
        .collect();
    let ratios = |solver_times: &Vec<Option<f64>>| {
        let pairs = solver_times.iter().zip(&fastest);
        share_within(
            pairs.filter_map(|(time, best)| Some((*time)? / best)),
            problems,
        )
    };
    times.iter().map(ratios).collect()
}

/// Fraction of `problems` solved within t, as points (t, fraction) by ascending t; `times` are those of the solved
/// problems.
#[must_use]
pub fn share_within(times: impl Iterator<Item = f64>, problems: usize) -> Vec<(f64, f64)> {
    let mut sorted: Vec<f64> = times.collect();
    sorted.sort_by(f64::total_cmp);
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(sorted.len());
    for (index, time) in sorted.into_iter().enumerate() {
        let share = (index + 1) as f64 / problems.max(1) as f64;
        match points.last_mut() {
            Some(last) if last.0 == time => last.1 = share,
            _ => points.push((time, share)),
        }
    }
    points
}

/// Median of some numbers, the mean of the middle two for an even count; `None` without numbers.
#[must_use]
pub fn median(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let (upper, lower) = (sorted.len() / 2, sorted.len().saturating_sub(1) / 2);
    Some(0.5 * (sorted.get(upper)? + sorted.get(lower)?))
}
