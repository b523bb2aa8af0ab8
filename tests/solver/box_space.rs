//! Promise: the configuration space of bounded variables steps, projects, measures and detects active bounds as a box.

use kinopt::solver::{ConfigurationSpace, Side};
use support::random::Random;

#[test]
fn box_space_steps_projects_and_holds() {
    let mut random = Random::new(19);
    let mut reported = [0; 3];
    for _ in 0..300 {
        let n = 4;
        let lower: Vec<f64> = (0..n).map(|_| random.within(-1.0, 0.0)).collect();
        let upper: Vec<f64> = (0..n).map(|_| random.within(0.0, 1.0)).collect();
        let space = ConfigurationSpace::new(&lower, &upper);
        assert!(space.is_of(n) && !space.is_of(n + 1));
        // One variable in three is on a bound.
        let x: Vec<f64> = (0..n)
            .map(|k| match random.below(6) {
                0 => lower[k],
                1 => upper[k],
                _ => random.within(lower[k], upper[k]),
            })
            .collect();
        let step: Vec<f64> = (0..n).map(|_| random.within(-1.5, 1.5)).collect();
        let (mut to, mut back) = (vec![f64::NAN; n], vec![f64::NAN; n]);
        space.integrate_share(&x, 0.5, &step, &mut to);
        let half: Vec<f64> = x
            .iter()
            .zip(&step)
            .map(|(x, step)| x + 0.5 * step)
            .collect();
        assert_eq!(to, half);
        space.integrate(&x, &step, &mut to);
        space.difference(&to, &x, &mut back);
        let largest = step
            .iter()
            .fold(0.0_f64, |largest, step| largest.max(step.abs()));
        assert!(back.iter().zip(&step).all(|(a, b)| (a - b).abs() < 1e-15));
        assert!((space.distance(&to, &x, &mut back) - largest).abs() < 1e-15);
        let mut inside = to.clone();
        space.project(&mut inside);
        let slope: Vec<f64> = (0..n).map(|_| random.within(-1.0, 1.0)).collect();
        let mut norm = 0.0_f64;
        for k in 0..n {
            assert_eq!(inside[k], to[k].max(lower[k]).min(upper[k]));
            assert_eq!(space.room(&x, k), (x[k] - lower[k], upper[k] - x[k]));
            let stopped = space.stopped_step(&x, k, step[k]);
            assert_eq!(stopped, (inside[k] != to[k]).then(|| inside[k] - x[k]));
            let mut one = x.clone();
            let taken = space.integrate_one(&x, k, 0.25, &mut one);
            assert!((taken - 0.25).abs() < 1e-15 && one[k] == x[k] + 0.25);
            space.return_one(&x, k, &mut one);
            assert_eq!(one, x);
            // The lower bound is active if the slope is positive there.
            let held = match () {
                () if x[k] == lower[k] && slope[k] > 0.1 => Some(Side::Lower),
                () if x[k] == upper[k] && slope[k] < -0.1 => Some(Side::Upper),
                () => None,
            };
            assert_eq!(space.held_at(&x, k, slope[k], 0.1), held);
            assert_eq!(space.holds(&x, k, slope[k], 0.1), held.is_some());
            reported[held.map_or(2, |side| usize::from(side == Side::Upper))] += 1;
            let minimum = (x[k] - slope[k] / 2.0).max(lower[k]).min(upper[k]);
            norm = norm.max((minimum - x[k]).abs());
        }
        assert!((space.projected_gradient_norm(&x, &slope, 2.0) - norm).abs() < 1e-15);
        let lost = vec![f64::NAN; n];
        assert!(space.projected_gradient_norm(&x, &lost, 2.0).is_nan());
    }
    assert!(reported.iter().all(|count| *count > 30), "{reported:?}");
}
