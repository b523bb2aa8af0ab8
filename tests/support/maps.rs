//! Parameter maps of every kind with an independent expansion.

use super::random::Random;
use super::trees::RandomTree;
use kinopt::model::{Limits, ParameterMap};

/// Map and its expected values: q_c = ratio_c x[variable_c] + offset_c, with ratio 0 for constants.
#[derive(Clone, Debug)]
pub struct ExpectedMap {
    pub name: &'static str,
    pub map: ParameterMap,
    pub rules: Vec<(Option<usize>, f64, f64)>,
}

impl ExpectedMap {
    pub fn expand(&self, x: &[f64]) -> Vec<f64> {
        self.rules
            .iter()
            .map(|&(variable, ratio, offset)| variable.map_or(0.0, |v| ratio * x[v]) + offset)
            .collect()
    }

    /// Random variables within the map's bounds; variables without bounds are within one turn.
    pub fn variables(&self, random: &mut Random) -> Vec<f64> {
        let bounds = self.map.lower().iter().zip(self.map.upper());
        bounds
            .map(|(&lower, &upper)| {
                let (low, high) = (lower.max(-3.0), upper.min(3.0));
                Limits::new(lower, upper).clamp(random.within(low, high))
            })
            .collect()
    }
}

fn middle(limits: &Limits) -> f64 {
    if limits.lower.is_finite() && limits.upper.is_finite() {
        0.5 * (limits.lower + limits.upper)
    } else {
        0.0
    }
}

/// Maps of a tree: all joints free, some locked, one pair coupled with a negative ratio, and a chain of two mimic
/// joints.
pub fn maps_of(tree: &RandomTree) -> Vec<ExpectedMap> {
    let model = &tree.model;
    let moving = model.moving_joints();
    let limits: Vec<Limits> = model.limits().collect();
    let free_rules = |n: usize| {
        (0..n)
            .map(|c| (Some(c), 1.0, 0.0))
            .collect::<Vec<(Option<usize>, f64, f64)>>()
    };
    let n = moving.len();
    let mut all = vec![ExpectedMap {
        name: "free",
        map: ParameterMap::free(model),
        rules: free_rules(n),
    }];

    let mut builder = ParameterMap::builder(model);
    let mut rules = Vec::new();
    let mut variable = 0;
    for c in 0..n {
        if c % 3 == 1 {
            let value = limits[c].clamp(middle(&limits[c]) + 0.1);
            builder = builder.with_locked(moving[c], value);
            rules.push((None, 0.0, value));
        } else {
            rules.push((Some(variable), 1.0, 0.0));
            variable += 1;
        }
    }
    all.push(ExpectedMap {
        name: "locked",
        map: builder.build().unwrap(),
        rules,
    });

    let (first, last) = (0, n - 1);
    let ratio = -0.6;
    let offset = middle(&limits[last]) - ratio * middle(&limits[first]);
    let mut rules = free_rules(n);
    rules[last] = (Some(first), ratio, offset);
    all.push(ExpectedMap {
        name: "coupled",
        map: ParameterMap::builder(model)
            .with_coupled(moving[last], moving[first], ratio, offset)
            .build()
            .unwrap(),
        rules,
    });

    // The first joint is a mimic joint of the last one, and the second of the first.
    let (outer, inner) = (1.5, 0.4);
    let outer_offset = middle(&limits[first]) - outer * middle(&limits[last]);
    let inner_offset = middle(&limits[1]) - inner * middle(&limits[first]);
    let mut rules: Vec<_> = (0..n)
        .map(|c| (Some(c.saturating_sub(2)), 1.0, 0.0))
        .collect();
    rules[first] = (Some(n - 3), outer, outer_offset);
    rules[1] = (
        Some(n - 3),
        inner * outer,
        inner * outer_offset + inner_offset,
    );
    all.push(ExpectedMap {
        name: "coupled in a chain",
        map: ParameterMap::builder(model)
            .with_coupled(moving[first], moving[last], outer, outer_offset)
            .with_coupled(moving[1], moving[first], inner, inner_offset)
            .build()
            .unwrap(),
        rules,
    });
    all
}
