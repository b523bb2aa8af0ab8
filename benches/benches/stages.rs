//! Stages of the library: forward kinematics, derivatives, iterations, the SIMD solver, the geometric methods, sampling
//! and skinning. The program `instructions` counts them under callgrind.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kinopt_benches::stages;

fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stages");
    for stage in stages() {
        group.throughput(Throughput::Elements(stage.elements));
        // Creates the input only for stages that pass the filter.
        group.bench_function(stage.name, |bencher| {
            let mut run = stage.build().expect("its input can be made");
            bencher.iter(&mut run);
        });
    }
    group.finish();
}

criterion_group!(benches, all);
criterion_main!(benches);
