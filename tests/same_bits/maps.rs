//! Promise: so it is for what a solver moves: parameter maps that lock, couple, narrow and choose joints, what is refused of
//! them and how they are written.
#![allow(clippy::unwrap_used)]

use kinopt::model::{JointId, Limits, Model, ParameterMap, ParameterMapBuilder};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, map, model, place};

pub(crate) fn joints<const N: usize>(model: &Model, names: [&str; N]) -> [JointId; N] {
    names.map(|name| model.joint(name).unwrap())
}

/// Everything that a map says and does.
fn told(digest: &mut Digest, model: &Model, map: &ParameterMap, random: &mut Random) {
    digest.noted(&(map.variables(), map.leaders(), map.sources()));
    digest.doubles(map.lower().iter().chain(map.upper()).copied());
    let (mut x, mut q) = (
        vec![0.0; map.variables()],
        vec![0.0; model.configuration_len()],
    );
    for _ in 0..4 {
        let given: Vec<f64> = x.iter().map(|_| random.within(-3.0, 3.0)).collect();
        map.expand(&given, &mut q).unwrap();
        digest.doubles(q.iter().copied());
        map.expand_within_limits(&given, &mut q).unwrap();
        digest.doubles(q.iter().copied());
        map.reduce(&configuration(model, random), &mut x).unwrap();
        digest.doubles(x.iter().copied());
        let far: Vec<f64> = q.iter().map(|_| random.within(-9.0, 9.0)).collect();
        map.reduce(&far, &mut x).unwrap();
        digest.doubles(x.iter().copied());
        map.expand(&x, &mut q).unwrap();
        digest.doubles(q.iter().copied());
    }
    let text = serde_json::to_string(map).unwrap();
    digest.bytes(&text);
    let back: ParameterMap = serde_json::from_str(&text).unwrap();
    digest.word((back == *map).into());
}

fn maps() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(131));
    for free in [false, true] {
        let model = model(&mut random, free);
        let q = configuration(&model, &mut random);
        let [chest, elbow, slide, wrist, hip, neck] =
            joints(&model, ["chest", "elbow", "slide", "wrist", "hip", "neck"]);
        let builder = || ParameterMap::builder(&model);
        let maps = [
            ParameterMap::identity(&model),
            ParameterMap::free(&model),
            builder().build().unwrap(),
            map(&model),
            builder()
                .with_only(&[elbow, hip, wrist], &q)
                .build()
                .unwrap(),
            builder()
                .with_locked(wrist, 0.3)
                .with_only(&[slide], &q)
                .build()
                .unwrap(),
            builder()
                .with_coupled(elbow, chest, 0.0, 0.7)
                .with_coupled(slide, wrist, 0.05, 0.1)
                .with_narrowed(slide, Limits::new(-0.1, 0.2))
                .with_narrowed(slide, Limits::new(-0.2, 0.15))
                .with_locked_ball(hip, [1.0, 0.1, 0.0, 0.2])
                .build()
                .unwrap(),
            builder()
                .with_locked(chest, 0.1)
                .with_coupled(elbow, chest, 2.0, 0.3)
                .with_narrowed(wrist, Limits::new(-1.0, 0.5))
                .build()
                .unwrap(),
        ];
        for map in &maps {
            told(&mut digest, &model, map, &mut random);
        }
        let mut x = vec![0.0; maps[1].variables()];
        let mut to = q.clone();
        digest.refusal(maps[1].expand(&x[1..], &mut to));
        digest.refusal(maps[1].expand(&x, &mut to[1..]));
        digest.refusal(maps[1].expand_within_limits(&x[1..], &mut to));
        digest.refusal(maps[1].reduce(&q[1..], &mut x));
        digest.refusal(maps[1].reduce(&q, &mut x[1..]));
        let ball = model.coordinate(neck).unwrap();
        to[ball + 3] = f64::NAN;
        digest.refusal(maps[1].reduce(&to, &mut x));
        x[1] = f64::INFINITY;
        digest.refusal(maps[1].expand(&x, &mut to));
    }
    digest.value()
}

fn refused_maps() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(132));
    let model = model(&mut random, false);
    let q = configuration(&model, &mut random);
    let [chest, elbow, slide, wrist, hip, plate] =
        joints(&model, ["chest", "elbow", "slide", "wrist", "hip", "plate"]);
    let mut more = kinopt::model::ModelBuilder::from_model(&model);
    let foreign = more.fixed("more", None, place(&mut random, 0.1));
    let builder = || ParameterMap::builder(&model);
    let mut lost = q.clone();
    let at = model.coordinate(hip).unwrap();
    lost[at..at + 4].fill(0.0);
    let mut nowhere = q.clone();
    nowhere[1] = f64::NAN;
    let wide = Limits::new(5.0, 6.0);
    let all: Vec<ParameterMapBuilder<'_>> = vec![
        builder().with_locked(chest, 2.0),
        builder().with_locked(chest, f64::NAN),
        builder().with_locked(chest, 0.1).with_locked(chest, 0.2),
        builder()
            .with_coupled(chest, elbow, 1.0, 0.0)
            .with_coupled(chest, wrist, 1.0, 0.0),
        builder()
            .with_coupled(chest, elbow, 1.0, 0.0)
            .with_coupled(elbow, chest, 1.0, 0.0),
        builder().with_coupled(chest, elbow, f64::INFINITY, 0.0),
        builder().with_coupled(chest, elbow, 1.0, f64::NAN),
        builder()
            .with_coupled(chest, elbow, 1e200, 0.0)
            .with_coupled(elbow, wrist, 1e200, 0.0),
        builder()
            .with_coupled(chest, elbow, 1.0, 1e200)
            .with_coupled(slide, chest, 1e200, 0.0),
        builder().with_coupled(chest, elbow, 1.0, 9.0),
        builder().with_coupled(chest, elbow, 0.0, 9.0),
        builder().with_coupled(chest, hip, 1.0, 0.0),
        builder().with_coupled(hip, chest, 1.0, 0.0),
        builder().with_narrowed(chest, wide),
        builder().with_narrowed(hip, wide),
        builder().with_narrowed(plate, wide),
        builder().with_locked(plate, 0.0),
        builder().with_locked(foreign, 0.0),
        builder().with_coupled(chest, foreign, 1.0, 0.0),
        builder().with_locked_ball(hip, [0.0; 4]),
        builder().with_locked_ball(elbow, [1.0, 0.0, 0.0, 0.0]),
        builder().with_locked_ball(plate, [1.0, 0.0, 0.0, 0.0]),
        builder().with_only(&[elbow], &q[1..]),
        builder().with_only(&[elbow], &lost),
        builder().with_only(&[elbow], &nowhere),
        builder().with_only(&[plate], &q),
        builder()
            .with_locked(chest, 0.1)
            .with_coupled(elbow, chest, 1.0, -9.0),
    ];
    for builder in all {
        digest.refusal(builder.build());
    }
    // Written maps with one thing changed.
    let text = serde_json::to_string(&map(&model)).unwrap();
    digest.bytes(&text);
    for (from, to) in [
        ("\"Constant\":0.2", "\"Constant\":null"),
        ("\"variable\":0", "\"variable\":99"),
        ("\"leaders\":[", "\"leaders\":[0,"),
        ("\"bounds\":[", "\"bounds\":[[2.0,1.0],"),
        ("\"limits\":[", "\"limits\":[[0.0,1.0],"),
        ("\"coordinate\":0", "\"coordinate\":1"),
        ("\"balls\":[", "\"balls\":[{}, "),
        ("[-0.9,0.4]", "[0.9,0.4]"),
    ] {
        digest.word(text.contains(from).into());
        digest.refusal(serde_json::from_str::<ParameterMap>(
            &text.replacen(from, to, 1),
        ));
    }
    digest.value()
}

#[test]
fn of_maps_and_problems() {
    check(&[
        ("parameter maps of every sort", maps()),
        ("parameter maps that are refused", refused_maps()),
    ]);
}
