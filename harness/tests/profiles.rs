//! Promise: performance profiles are those of Dolan and Moré, on examples computed by hand.

use kinopt_harness::profile::{median, performance_profile, share_within};

#[test]
fn profile_of_three_solvers_matches_hand_count() {
    let times = vec![
        // Fastest on the first, twice the fastest on the second, never on the third.
        vec![Some(1.0), Some(4.0), None, None],
        // Four times, fastest, fastest.
        vec![Some(4.0), Some(2.0), Some(3.0), None],
        // Never, ten times, equally fast as the fastest.
        vec![None, Some(20.0), Some(3.0), None],
    ];
    // ρ(τ) over four problems, one of which nobody solves.
    let expected = [
        vec![(1.0, 0.25), (2.0, 0.5)],
        vec![(1.0, 0.5), (4.0, 0.75)],
        vec![(1.0, 0.25), (10.0, 0.5)],
    ];
    assert_eq!(performance_profile(&times), expected);
}

#[test]
fn profile_without_solutions_is_empty() {
    assert_eq!(performance_profile(&[]), Vec::<Vec<(f64, f64)>>::new());
    assert_eq!(performance_profile(&[vec![None, None]]), [vec![]]);
}

#[test]
fn share_and_median_match_hand_count() {
    let times = [5.0, 1.0, 5.0];
    assert_eq!(
        share_within(times.into_iter(), 4),
        [(1.0, 0.25), (5.0, 0.75)]
    );
    assert_eq!(median(times.into_iter()), Some(5.0));
    assert_eq!(median([1.0, 4.0].into_iter()), Some(2.5));
    assert_eq!(median(std::iter::empty()), None);
}
