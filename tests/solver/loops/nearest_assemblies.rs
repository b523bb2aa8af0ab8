//! Promise: of several assemblies of a mechanism, forward kinematics selects the one nearest to the passive joints'
//! values, without additional whole turns.

use std::f64::consts::{PI, TAU};

use kinopt::ik::LoopClosure;
use kinopt::model::{Limits, Loop, Model, ModelBuilder, ParameterMap};
use kinopt::spatial::{Placement, Vector3};
use support::random::{Random, case_count, cases};

use crate::loops::mechanisms::{FourBar, ROTATION_LIMITS};

/// Coupler and rocker angles for a crank angle, from the two intersections of the circles of their ends.
fn assemblies(linkage: &FourBar, crank: f64) -> [[f64; 2]; 2] {
    let tip = [linkage.crank * crank.cos(), linkage.crank * crank.sin()];
    let (x, y) = (linkage.ground - tip[0], -tip[1]);
    let apart = x.hypot(y);
    let (b, c) = (linkage.coupler, linkage.rocker);
    let along = (b * b - c * c + apart * apart) / (2.0 * apart);
    let height = (b * b - along * along).sqrt();
    [1.0, -1.0].map(|side| {
        let end = [
            tip[0] + (along * x - side * height * y) / apart,
            tip[1] + (along * y + side * height * x) / apart,
        ];
        let coupler = (end[1] - tip[1]).atan2(end[0] - tip[0]) - crank;
        let rocker = end[1].atan2(end[0] - linkage.ground);
        [coupler, rocker]
    })
}

/// Smallest joint distance from `start`, with each joint at its nearest turn within `limits`.
fn distance(start: [f64; 2], angles: [f64; 2], limits: Limits) -> f64 {
    let moved = start.iter().zip(angles).map(|(start, angle)| {
        let turns = (-3..=3).map(|k| angle + TAU * f64::from(k));
        let within = turns.filter(|angle| limits.contains(*angle));
        within
            .map(|angle| (angle - start).abs())
            .fold(f64::INFINITY, f64::min)
    });
    moved.map(|moved| moved * moved).sum::<f64>().sqrt()
}

/// The linkage with continuous joints.
fn endless(linkage: &FourBar) -> Model {
    let mut builder = ModelBuilder::from_model(&linkage.model().without_loops());
    linkage
        .model()
        .loops()
        .iter()
        .for_each(|closure| builder.close(closure.clone()));
    let model = builder.build().unwrap();
    let mut endless = Model::builder("endless");
    for joint in model.joints() {
        let (name, at) = (&joint.name, joint.parent_from_joint);
        endless.continuous(name, joint.parent, at, joint.axis);
    }
    for frame in model.frames() {
        endless.frame(&frame.name, frame.joint, frame.joint_from_frame);
    }
    model
        .loops()
        .iter()
        .for_each(|closure| endless.close(closure.clone()));
    endless.build().unwrap()
}

#[test]
fn nearer_assembly_is_selected() {
    let linkage = FourBar::CRANK_ROCKER;
    for (model, limits, seed) in [
        (linkage.model(), ROTATION_LIMITS, 1),
        (endless(&linkage), Limits::UNBOUNDED, 2),
    ] {
        let dependent = ["coupler", "rocker"].map(|name| model.joint(name).unwrap());
        let closure = LoopClosure::new(ParameterMap::builder(&model), &dependent).unwrap();
        let mut random = Random::new(seed);
        for case in cases(300, 100) {
            let mut q = [(); 3].map(|()| random.within(-PI, PI));
            let start = [q[1], q[2]];
            closure.close(&mut q).unwrap();
            assert!(closure.gaps(&q).unwrap()[0].is_closed());
            let moved = (q[1] - start[0]).hypot(q[2] - start[1]);
            let ways = assemblies(&linkage, q[0]);
            let nearest = ways.map(|assembly| distance(start, assembly, limits));
            let nearest = nearest[0].min(nearest[1]);
            assert!(
                moved < nearest + 1e-6,
                "{case}: {moved} instead of {nearest}"
            );
        }
    }
}

#[test]
fn whole_turns_are_kept() {
    let model = endless(&FourBar::CRANK_ROCKER);
    let dependent = ["coupler", "rocker"].map(|name| model.joint(name).unwrap());
    let closure = LoopClosure::new(ParameterMap::builder(&model), &dependent).unwrap();
    let mut plain = [0.7, 0.5, 2.0];
    closure.close(&mut plain).unwrap();
    let mut wound = [0.7, 0.5 + 3.0 * TAU, 2.0 - 5.0 * TAU];
    closure.close(&mut wound).unwrap();
    for (wound, (plain, turns)) in wound.iter().zip(plain.iter().zip([0.0, 3.0, -5.0])) {
        assert!(
            (wound - plain - turns * TAU).abs() < 1e-7,
            "{wound} {plain}"
        );
    }
}

/// Whole turns of one joint would rotate the other by a fraction.
#[test]
fn source_joint_moves_its_mimic_joint() {
    let linkage = endless(&FourBar::CRANK_ROCKER);
    let mut builder = Model::builder("geared");
    for joint in linkage.joints() {
        let (name, at) = (&joint.name, joint.parent_from_joint);
        builder.continuous(name, joint.parent, at, joint.axis);
    }
    let rocker = linkage.joint("rocker").unwrap();
    let (origin, z) = (Placement::identity(), Vector3::UNITS[2]);
    let gear = builder.continuous("gear", Some(rocker), origin, z);
    for frame in linkage.frames() {
        builder.frame(&frame.name, frame.joint, frame.joint_from_frame);
    }
    for closure in linkage.loops() {
        builder.close(closure.clone());
    }
    let model = builder.build().unwrap();
    let dependent = ["coupler", "rocker"].map(|name| model.joint(name).unwrap());
    let map = ParameterMap::builder(&model).with_coupled(gear, rocker, 0.25, 0.1);
    let closure = LoopClosure::new(map, &dependent).unwrap();
    let mut random = Random::new(4);
    for case in cases(300, 100) {
        let mut q = [(); 4].map(|()| random.within(-PI, PI));
        closure.close(&mut q).unwrap();
        assert!(closure.gaps(&q).unwrap()[0].is_closed());
        let deviation = q[3] - (0.25 * q[2] + 0.1);
        assert!(deviation.abs() < 1e-12, "{case}: {deviation}");
    }
}

/// Crank, rod and slider with lengths times `unit`: the crank at the origin, the slider's line parallel to x.
fn slider_crank(unit: f64) -> Model {
    let along = |length: f64| Placement::translation(Vector3::new(length * unit, 0.0, 0.0));
    let [x, y, z] = Vector3::UNITS;
    let mut builder = Model::builder("slider-crank");
    let crank = builder.revolute("crank", None, along(0.0), z, ROTATION_LIMITS);
    let rod = builder.revolute("rod", Some(crank), along(0.3), z, ROTATION_LIMITS);
    let line = Placement::translation(y * (0.2 * unit));
    let slide = builder.prismatic("slide", None, line, x, Limits::new(-2.0 * unit, 2.0 * unit));
    let ends = [
        builder.frame("rod end", Some(rod), along(0.8)),
        builder.frame("slider", Some(slide), along(0.0)),
    ];
    builder.close(Loop::connect("pin", ends));
    builder.build().unwrap()
}

/// The nearer of two assemblies, one with less rotation and one with less translation, does not depend on the unit of
/// length.
#[test]
fn nearer_assembly_is_unit_invariant() {
    const MILLIMETRES_PER_METRE: f64 = 1000.0;
    let models = [1.0, MILLIMETRES_PER_METRE].map(slider_crank);
    let [metres, millimetres] = models.each_ref().map(|model| {
        let dependent = ["rod", "slide"].map(|name| model.joint(name).unwrap());
        LoopClosure::new(ParameterMap::builder(model), &dependent).unwrap()
    });
    let mut random = Random::new(3);
    let mut ahead = 0;
    let case_count = case_count(300, 100);
    for case in 0..case_count {
        let [crank, rod] = [(); 2].map(|()| random.within(-PI, PI));
        let slide = random.within(-1.2, 1.2);
        let (mut small, mut large) = (
            [crank, rod, slide],
            [crank, rod, slide * MILLIMETRES_PER_METRE],
        );
        metres.close(&mut small).unwrap();
        millimetres.close(&mut large).unwrap();
        // The two positions of the slider by Pythagoras.
        let (sin, cos) = crank.sin_cos();
        let half = (0.64 - (0.3 * sin - 0.2).powi(2)).sqrt();
        let ends = [0.3 * cos + half, 0.3 * cos - half];
        let deviation = ends.map(|end| (small[2] - end).abs());
        assert!(deviation[0].min(deviation[1]) < 1e-5, "{case}: {small:?}");
        ahead += usize::from(deviation[0] < deviation[1]);
        let scaled = [large[0], large[1], large[2] / MILLIMETRES_PER_METRE];
        for (one, other) in small.iter().zip(scaled) {
            assert!((one - other).abs() < 1e-5, "{case}: {small:?} {scaled:?}");
        }
    }
    assert!(
        ahead * 4 > case_count && ahead * 4 < 3 * case_count,
        "{ahead}"
    );
}

/// Also the coordinates of a ball joint, whose quaternion may have any length.
#[test]
fn joints_outside_the_loop_keep_their_values() {
    let linkage = FourBar::CRANK_ROCKER;
    let mut builder = Model::builder("figure");
    let [_, coupler, rocker] = linkage.add_to(&mut builder, None);
    let at = Placement::identity();
    builder.ball("head", None, at, Vector3::UNITS[2], None);
    let model = builder.build().unwrap();
    let map = ParameterMap::builder(&model);
    let closure = LoopClosure::new(map, &[coupler, rocker]).unwrap();
    let mut q = vec![0.7, 0.5, 1.5, 1.2, 0.4, -0.6, 0.2];
    let before = q.clone();
    closure.close(&mut q).unwrap();
    assert_eq!((q[0], &q[3..]), (before[0], &before[3..]));
    assert!(linkage.freudenstein(q[0], q[2]).abs() < 1e-8, "{q:?}");
}
