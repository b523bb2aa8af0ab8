//! Promise: so it is for parameter maps on which everything is asked together, and for models and maps whose files are changed.
#![allow(clippy::unwrap_used)]

use kinopt::model::{JointId, Limits, Loop, Model, ParameterMap};
use kinopt::spatial::{Placement, Vector3};
use support::changed_json;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, map, model};
use crate::robot_texts::{add_error, add_text};

const VALUES: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.25,
    2.0,
    1e-3,
    3.0,
    -4.0,
    1e200,
    -1e200,
    f64::INFINITY,
    f64::NAN,
];

/// A value that is most often an ordinary one.
fn value(random: &mut Random) -> f64 {
    let among = if random.below(6) == 0 { 14 } else { 9 };
    VALUES[random.below(among)]
}

fn limits(random: &mut Random) -> Limits {
    let (a, b) = (value(random), value(random));
    match random.below(8) {
        0 => Limits::UNBOUNDED,
        1 => Limits::new(a, a),
        2 => Limits::new(a, b),
        _ => Limits::new(a.min(b), a.max(b)),
    }
}

/// All that a map says and does, ahead and back.
fn add(digest: &mut Digest, model: &Model, map: &ParameterMap, random: &mut Random) {
    let text = format!(
        "{:?} {:?} {:?}",
        map.leaders(),
        map.sources(),
        map.variables()
    );
    add_text(digest, &text);
    digest.doubles(map.lower().iter().chain(map.upper()).copied());
    let mut x: Vec<f64> = map
        .lower()
        .iter()
        .map(|_| random.within(-3.0, 3.0))
        .collect();
    let mut q = vec![0.0; model.configuration_len()];
    for expanded in [ParameterMap::expand, ParameterMap::expand_within_limits] {
        match expanded(map, &x, &mut q) {
            Ok(()) => digest.doubles(q.iter().copied()),
            Err(error) => add_error(digest, &error),
        }
    }
    match map.reduce(&configuration(model, random), &mut x) {
        Ok(()) => digest.doubles(x.iter().copied()),
        Err(error) => add_error(digest, &error),
    }
}

fn mixes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(951));
    let models = [model(&mut random, false), model(&mut random, true)];
    let foreign = models[1].joint_ids().last().unwrap();
    for round in 0..240 {
        let model = &models[round % 2];
        let every: Vec<JointId> = model.joint_ids().collect();
        let single = |id: &&JointId| {
            let joint = &model.joints()[id.index()];
            joint.kind.coordinates() == 1
        };
        let hinges: Vec<JointId> = every.iter().filter(single).copied().collect();
        let balls = every
            .iter()
            .filter(|id| model.joints()[id.index()].kind.is_ball());
        let balls: Vec<JointId> = balls.copied().collect();
        let mut builder = ParameterMap::builder(model);
        for _ in 0..=random.below(4) {
            let any = match random.below(20) {
                0 => foreign,
                1..=3 => every[random.below(every.len())],
                _ => hinges[random.below(hinges.len())],
            };
            let other = hinges[random.below(hinges.len())];
            builder = match random.below(10) {
                0 | 1 => builder.with_locked(any, value(&mut random)),
                2 => {
                    let ball = if random.below(6) == 0 {
                        any
                    } else {
                        balls[random.below(balls.len())]
                    };
                    let turned = [(); 4].map(|()| value(&mut random));
                    builder.with_locked_ball(ball, turned)
                }
                3..=5 => builder.with_coupled(any, other, value(&mut random), value(&mut random)),
                6 | 7 => builder.with_narrowed(any, limits(&mut random)),
                _ => {
                    let mut q = configuration(model, &mut random);
                    match random.below(8) {
                        0 => drop(q.pop()),
                        1 => {
                            let at = random.below(q.len());
                            q[at] = value(&mut random);
                        }
                        _ => {}
                    }
                    let count = random.below(4);
                    let free: Vec<JointId> = (0..count)
                        .map(|_| every[random.below(every.len())])
                        .collect();
                    builder.with_only(&free, &q)
                }
            };
        }
        match builder.build() {
            Ok(map) => add(&mut digest, model, &map, &mut random),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

fn files() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(952));
    let model = model(&mut random, true);
    for text in changed_json::changed(
        &serde_json::to_string(&map(&model)).unwrap(),
        160,
        &mut random,
    ) {
        match serde_json::from_str::<ParameterMap>(&text) {
            Ok(map) => add(&mut digest, &model, &map, &mut random),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    // Balls whose parts are not one's own.
    let whole = serde_json::to_value(map(&model)).unwrap();
    let leaders = whole["leaders"].as_array().unwrap().len();
    for at in 0..leaders {
        for to in 0..whole["sources"].as_array().unwrap().len() {
            let mut own = whole.clone();
            own["leaders"][at] = to.into();
            let read = serde_json::from_value::<ParameterMap>(own);
            digest.word(read.is_ok().into());
        }
    }
    for text in changed_json::changed(&serde_json::to_string(&model).unwrap(), 90, &mut random) {
        match serde_json::from_str::<Model>(&text) {
            Ok(model) => {
                add_text(&mut digest, &serde_json::to_string(&model).unwrap());
                let told = (
                    model.degrees_of_freedom(),
                    model.moving_joints(),
                    model.reach(),
                );
                add_text(&mut digest, &format!("{told:?}"));
            }
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

/// Rings of hinges, slides of every range and fixed joints on two branches, some of which cannot close.
fn rings() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(953));
    let [x, y, z] = Vector3::UNITS;
    for _ in 0..180 {
        let mut builder = Model::builder("ring");
        let mut ends = Vec::new();
        let mut count = 0;
        for _ in 0..2 {
            let mut parent = None;
            for _ in 0..random.below(4) {
                let at = [x, y, z][random.below(3)] * [0.0, 0.0, 0.5, 2.0][random.below(4)];
                let (name, at) = (format!("j{count}"), Placement::translation(at));
                count += 1;
                let reach = [0.1, 0.5, 2.0, f64::INFINITY][random.below(4)];
                let range = [
                    Limits::new(-reach, 0.25),
                    Limits::new(1.0, reach.max(1.5)),
                    Limits::new(-reach.max(1.5), -1.0),
                ][random.below(3)];
                parent = Some(match random.below(4) {
                    0 => builder.fixed(name, parent, at),
                    1 => builder.continuous(name, parent, at, z),
                    _ => builder.prismatic(name, parent, at, x, range),
                });
            }
            let at = Placement::translation(y * [0.0, 0.3, 1.5][random.below(3)]);
            ends.push(builder.frame(format!("end{}", ends.len()), parent, at));
        }
        let ends = [ends[0], ends[1]];
        let ring = match random.below(2) {
            0 => Loop::weld("ring", ends),
            _ => Loop::connect("ring", ends),
        };
        let place = Placement::translation(z * [0.0, 0.0, 0.7][random.below(3)]);
        builder.close(ring.at([place, Placement::identity()]));
        match builder.build() {
            Ok(model) => {
                let joints = model.loop_joints(&model.loops()[0]);
                add_text(&mut digest, &format!("{joints:?} {}", model.reach()));
            }
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

#[test]
fn of_mixed_maps() {
    check(&[
        ("rings of models, mixed", rings()),
        ("maps, everything asked together", mixes()),
        ("maps and models, files changed", files()),
    ]);
}
