//! Promise: so it is for models: where frames of a body with joints of every kind stand and how they move,
//! configurations that are moved, compared and drawn, what is refused and in which words, what is written and
//! read back.
#![allow(clippy::unwrap_used)]

use kinopt::kinematics::{
    ForwardKinematics, Jacobian, centre_of_mass, centre_of_mass_jacobian, frame_jacobian,
};
use kinopt::model::{Limits, Model, ModelBuilder, ParameterMap};
use kinopt::scalar::Dual;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, looped, map, masses, model, place, vector};

/// Where frames stand and how they move, at configurations and under a map, with memory used again.
fn moved() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(111));
    for free in [false, true] {
        let model = model(&mut random, free);
        let map = map(&model);
        let some = frames(&model, &["foot", "anchor", "hand", "head", "back"]);
        let mut all = ForwardKinematics::new(&model);
        let mut own = Jacobian::new(ForwardKinematics::of_frames(&model, &some).unwrap());
        let under = ForwardKinematics::under(&model, &map, &some).unwrap();
        digest.placement(&under.placements()[1]);
        let mut under = Jacobian::new(under);
        digest.noted(&[
            own.variables(),
            own.columns(),
            under.variables(),
            under.columns(),
            all.variables(),
        ]);
        let masses = masses(&model, &mut random);
        digest.noted(&masses);
        digest.doubles([masses.total()]);
        digest.noted(&masses.points());
        for _ in 0..6 {
            let q = configuration(&model, &mut random);
            let mut x = vec![0.0; map.variables()];
            map.reduce(&q, &mut x).unwrap();
            all.place(&q).unwrap();
            all.placements().iter().for_each(|p| digest.placement(p));
            digest.doubles(own.at(&q).unwrap().iter().copied());
            own.placements().iter().for_each(|p| digest.placement(p));
            digest.doubles(under.at(&x).unwrap().iter().copied());
            under.placements().iter().for_each(|p| digest.placement(p));
            digest.doubles(centre_of_mass(&model, &masses, &q).unwrap().to_array());
            let jacobian = centre_of_mass_jacobian(&model, &masses, &q).unwrap();
            digest.doubles(jacobian.iter().copied());
            let jacobian = frame_jacobian(&model, some[3], &q).unwrap();
            digest.doubles(jacobian.iter().copied());
            // With derivatives along a way.
            let duals: Vec<Dual<1>> = q.iter().map(|&v| Dual::new(v, [v * v])).collect();
            let mut along = ForwardKinematics::<Dual<1>>::of_frames(&model, &some).unwrap();
            for placed in along.place(&duals).unwrap() {
                for part in placed
                    .translation
                    .to_array()
                    .into_iter()
                    .chain(placed.rotation.y.to_array())
                {
                    digest.doubles([part.value(), part.derivatives()[0]]);
                }
            }
        }
        let q = configuration(&model, &mut random);
        digest.refusal(all.place(&q[1..]));
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut q = q.clone();
            q[2] = wrong;
            digest.refusal(all.place(&q));
            digest.refusal(own.at(&q));
            digest.refusal(centre_of_mass(&model, &masses, &q));
            digest.refusal(frame_jacobian(&model, some[0], &q));
        }
        let waist = model.coordinate(model.joint("waist").unwrap()).unwrap();
        let mut q = q;
        q[waist..waist + 4].fill(0.0);
        digest.refusal(all.place(&q));
        let other = Model::builder("other").build().unwrap();
        digest.refusal(ForwardKinematics::<f64>::of_frames(&other, &some));
        digest.refusal(ForwardKinematics::<f64>::under(&other, &map, &[]));
        digest.refusal(ForwardKinematics::<f64>::under(
            &model,
            &ParameterMap::free(&other),
            &[],
        ));
        digest.refusal(centre_of_mass_jacobian(&other, &masses, &[]));
    }
    digest.value()
}

/// Configurations moved, compared, drawn, held against limits.
fn configurations() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(112));
    for free in [true, false] {
        let model = model(&mut random, free);
        let (n, dof) = (model.configuration_len(), model.degrees_of_freedom());
        digest.noted(&(n, dof, model.free_joints(), model.moving_joints()));
        digest.noted(&model.limits().collect::<Vec<_>>());
        digest.doubles([model.reach()]);
        digest.doubles(model.neutral());
        let (mut to, mut v) = (vec![0.0; n], vec![0.0; dof]);
        for seed in 0..8 {
            let from = configuration(&model, &mut random);
            let drawn = model.random_configuration(seed);
            digest.doubles(drawn.iter().copied());
            digest.word(model.is_within_limits(&drawn).into());
            digest.noted(&model.joints_outside_limits(&from).unwrap());
            let size = [0.0, 1e-3, 0.5, 3.0][seed as usize % 4];
            let velocity: Vec<f64> = (0..dof).map(|_| random.within(-size, size)).collect();
            model.integrate(&from, &velocity, &mut to).unwrap();
            digest.doubles(to.iter().copied());
            digest.word(model.is_within_limits(&to).into());
            model.difference(&from, &to, &mut v).unwrap();
            digest.doubles(v.iter().copied());
            model.difference(&drawn, &from, &mut v).unwrap();
            digest.doubles(v.iter().copied());
            for share in [0.0, 0.3, 1.0, -0.5, 1.7] {
                model.interpolate(&from, &drawn, share, &mut to).unwrap();
                digest.doubles(to.iter().copied());
            }
            let mut unit = from.clone();
            model.normalise(&mut unit).unwrap();
            digest.doubles(unit);
        }
        let q = model.neutral();
        digest.word(model.is_within_limits(&q[1..]).into());
        digest.refusal(model.interpolate(&q, &q, f64::NAN, &mut to));
        digest.refusal(model.integrate(&q, &v[1..], &mut to));
        digest.refusal(model.integrate(&q, &v, &mut to[1..]));
        digest.refusal(model.integrate(&q[1..], &v, &mut to));
        digest.refusal(model.difference(&q, &q[2..], &mut v));
        digest.refusal(model.difference(&q, &q, &mut v[2..]));
        v[2] = f64::INFINITY;
        digest.refusal(model.integrate(&q, &v, &mut to));
        let mut lost = q.clone();
        lost[n - 1] = f64::NAN;
        digest.refusal(model.normalise(&mut lost));
        digest.refusal(model.joints_outside_limits(&lost));
        let ball = model.coordinate(model.joint("neck").unwrap()).unwrap();
        lost = q;
        lost[ball..ball + 4].fill(0.0);
        digest.refusal(model.difference(&lost, &lost, &mut v));
        digest.word(model.is_within_limits(&lost).into());
    }
    digest.value()
}

/// What serde writes and what of it is read back, models grown and changed.
fn written() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(115));
    let model = looped(&mut random);
    for closed in model.loops() {
        digest.noted(&(closed, closed.kind.name(), model.loop_joints(closed)));
    }
    digest.noted(
        &model
            .joint_ids()
            .map(|id| model.moves_a_loop(id))
            .collect::<Vec<_>>(),
    );
    digest.noted(&model.clone().without_loops().loops().len());
    let text = serde_json::to_string(&model).unwrap();
    digest.bytes(&text);
    let back: Model = serde_json::from_str(&text).unwrap();
    digest.bytes(serde_json::to_string(&back).unwrap());
    digest.noted(&(
        back.name(),
        back.length_unit(),
        back.joints(),
        back.frames(),
    ));
    for (from, to) in [
        ("\"hand\"", "\"tray\""),
        ("[-0.9,0.4]", "[0.9,0.4]"),
        ("\"Ball\"", "\"Fixed\""),
    ] {
        digest.refusal(serde_json::from_str::<Model>(&text.replacen(from, to, 1)));
    }
    let mut grown = ModelBuilder::from_model(&model);
    let hand = model.joint("wrist").unwrap();
    let finger = grown.revolute(
        "finger",
        Some(hand),
        place(&mut random, 0.1),
        vector(&mut random, 1.0),
        Limits::new(0.0, 1.0),
    );
    grown.frame("fingertip", Some(finger), place(&mut random, 0.1));
    digest.refusal(grown.clone().build());
    let mut order: Vec<_> = model.moving_joints().to_vec();
    order.dedup();
    order.push(finger);
    grown.configuration_order(order);
    let grown = grown.build().unwrap();
    digest.bytes(serde_json::to_string(&grown).unwrap());
    let origins = grown
        .joint_ids()
        .step_by(3)
        .map(|id| (id, [0.1, 0.2, -0.3]));
    let moved = grown.clone().with_joint_origins(origins).unwrap();
    digest.bytes(serde_json::to_string(&moved).unwrap());
    digest.refusal(model.clone().with_joint_origins([(finger, [0.0; 3])]));
    digest.refusal(model.with_joint_origins([(hand, [f64::NAN; 3])]));
    digest.value()
}

#[test]
fn of_models() {
    check(&[
        ("a body of every joint, placed and moved", moved()),
        ("configurations moved, compared and drawn", configurations()),
        ("models as they are written", written()),
    ]);
}
