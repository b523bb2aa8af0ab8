//! Two links of one metre in a plane, with problems for their tip.
#![allow(dead_code, clippy::unwrap_used)]

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::Model;
use kinopt::model::{FrameId, Limits};
use kinopt::spatial::{Placement, Vector3};
use kinopt_harness::{Adapter, Bench, Budget, ProblemSet, Results};

/// Shoulder and elbow rotate about z within two radians in both directions.
pub(crate) fn two_links() -> (Model, FrameId) {
    let mut builder = Model::builder("two links");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
    let limits = Limits::new(-2.0, 2.0);
    let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
    let tip = builder.frame("tip", Some(elbow), link);
    (builder.build().unwrap(), tip)
}

/// Points for the tip, with random starts.
pub(crate) fn points(count: usize) -> ProblemSet {
    let (model, tip) = two_links();
    let set = ProblemSet::builder(&model).point(tip).build().unwrap();
    set.with_random_cases(count, 7, None).unwrap()
}

/// A budget whose clock ends no search.
pub(crate) fn patient(attempts: usize) -> Budget {
    Budget {
        time_limit: Duration::from_secs(3600),
        attempts,
    }
}

/// One solver on a set.
pub(crate) fn run(set: &ProblemSet, adapter: impl Adapter + 'static) -> Results {
    let mut bench = Bench::new(set, patient(2));
    bench.add(adapter);
    bench.run(&mut |_| ControlFlow::Continue(())).unwrap()
}
