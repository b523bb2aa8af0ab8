//! One frame of a character of 67 bones: sampling at 60 Hz, and conversion of local to model transforms. Throughput is
//! in bones.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Affine3A;
use kinopt::animation::{Cursor, Playback};
use kinopt_benches::{Keying, Sequence, armature, clip};

const BONES: usize = 67;

fn a_character(criterion: &mut Criterion) {
    let armature = armature(BONES);
    let mut group = criterion.benchmark_group("67 bones");
    group.throughput(Throughput::Elements(BONES as u64));
    let mut pose = armature.rest().clone();
    for keying in Keying::ALL {
        let clip = clip(&armature, keying, &mut Sequence::new(0.5));
        let (mut cursor, mut frame) = (Cursor::new(), 0_u32);
        group.bench_function(format!("sample at 60 Hz, {keying:?}"), |bencher| {
            bencher.iter(|| {
                frame += 1;
                let elapsed = f64::from(frame) / 60.0;
                clip.sample(elapsed, Playback::Loop, &mut cursor, &mut pose)
                    .expect("the clip's own armature");
            });
        });
    }
    let mut model = vec![Affine3A::IDENTITY; BONES];
    group.bench_function("local to model", |bencher| {
        bencher.iter(|| {
            armature
                .local_to_model(&pose, &mut model)
                .expect("its own pose");
        });
    });
    group.finish();
}

criterion_group!(benches, a_character);
criterion_main!(benches);
