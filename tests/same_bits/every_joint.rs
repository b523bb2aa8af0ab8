//! A body that has a joint of every kind, for the digests of the core; made by products and roots only.
#![allow(clippy::unwrap_used)]

use std::fmt::{Debug, Display};

use kinopt::Solution;
use kinopt::model::{
    BallLimits, FrameId, Limits, Loop, Masses, Model, ModelBuilder, ParameterMap, PointMass,
};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::Quantity;
use support::random::Random;

use crate::digest::Digest;

impl Digest {
    /// What is data only, as it is written down.
    pub(crate) fn noted(&mut self, what: &impl Debug) {
        self.bytes(format!("{what:?}\n"));
    }

    /// What a refusal says, or that there was none.
    pub(crate) fn refusal<T, E: Display>(&mut self, result: Result<T, E>) {
        self.text(match result {
            Ok(_) => "taken\n".to_owned(),
            Err(error) => format!("{error}\n"),
        });
    }

    /// Everything that a solution says, in words and as it is written.
    pub(crate) fn told(&mut self, solution: &Solution) {
        self.solution(solution);
        self.text(solution.explain());
        self.bytes(serde_json::to_string(solution).unwrap());
        for task in solution.tasks() {
            let errors = (task.position_error(), task.orientation_error());
            self.noted(&(
                task.name,
                task.frame,
                task.role,
                task.is_loop,
                task.level,
                errors,
            ));
        }
        let errors = (solution.position_error(), solution.orientation_error());
        self.noted(&(
            errors,
            solution.error(Quantity::Ratio),
            solution.loops_closed(),
        ));
        self.noted(&(solution.goals_reached(), solution.collisions()));
        solution.open_loops().for_each(|open| self.noted(&open));
        solution
            .active_limits()
            .for_each(|limit| self.noted(&limit));
    }

    /// A placement's rotation, by columns, and translation.
    pub(crate) fn placement(&mut self, own: &Placement<f64>) {
        let Placement {
            rotation,
            translation,
        } = own;
        for v in [rotation.x, rotation.y, rotation.z, *translation] {
            self.doubles(v.to_array());
        }
    }
}

/// Three numbers within ±`size`.
pub(crate) fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    [(); 3].map(|()| random.within(-size, size)).into()
}

/// Turned by up to three radians an axis, and moved.
pub(crate) fn place(random: &mut Random, size: f64) -> Placement<f64> {
    let turned = rotation_exp(vector(random, 3.0));
    Placement::new(turned, vector(random, size))
}

/// Joints of every kind on a trunk, two arms and a leg, whose base may be free within a room; a frame on each of them.
pub(crate) fn builder(random: &mut Random, free: bool) -> ModelBuilder {
    let [x, y, z] = Vector3::UNITS;
    let mut own = Model::builder("every joint");
    let room = [
        Limits::new(-1.0, 2.0),
        Limits::new(-0.5, 0.5),
        Limits::UNBOUNDED,
    ];
    let base = free.then(|| own.free("base", None, place(random, 0.5), room));
    let at = place(random, 0.3);
    let waist = own.ball("waist", base, at, vector(random, 2.0), None);
    let shift = Placement::translation(vector(random, 0.4));
    let chest = own.revolute("chest", Some(waist), shift, x, Limits::new(-0.9, 0.4));
    let twist = Limits::new(-0.8, 1.1);
    let shoulder = Some(BallLimits::cone(0.9, twist));
    let shoulder = own.ball("shoulder", Some(chest), place(random, 0.4), x, shoulder);
    let elbow = own.revolute(
        "elbow",
        Some(shoulder),
        place(random, 0.3),
        y,
        Limits::new(0.1, 2.4),
    );
    let plate = own.fixed("plate", Some(elbow), place(random, 0.1));
    let wrist = own.continuous("wrist", Some(plate), place(random, 0.2), z);
    let across = vector(random, 1.0);
    let hip =
        Some(BallLimits::elliptic(across, [0.7, 1.2], Limits::new(-0.4, 0.6)).with_angle(1.1));
    let hip = own.ball(
        "hip",
        Some(waist),
        place(random, 0.3),
        vector(random, 1.0),
        hip,
    );
    let [one, other] = [vector(random, 2.0), vector(random, 0.5)];
    let limits = [Limits::new(-1.0, 0.7), Limits::new(-2.0, 2.0)];
    let ankle = own.universal("ankle", Some(hip), place(random, 0.4), [one, other], limits);
    let axis = vector(random, 3.0);
    let slide = own.prismatic(
        "slide",
        Some(chest),
        place(random, 0.2),
        axis,
        Limits::new(-0.3, 0.5),
    );
    let held = own.revolute(
        "held",
        Some(slide),
        place(random, 0.2),
        axis,
        Limits::new(0.3, 0.3),
    );
    let ball = Some(BallLimits::within_angle(0.8));
    let neck = own.ball("neck", Some(held), place(random, 0.2), z, ball);
    let room = [Limits::new(-0.4, 0.2), Limits::new(-0.1, 0.6)];
    let desk = own.planar(
        "desk",
        None,
        place(random, 0.6),
        vector(random, 1.0),
        room,
        Limits::UNBOUNDED,
    );
    own.frame("anchor", None, place(random, 0.7));
    for (name, joint) in [
        ("middle", waist),
        ("hand", wrist),
        ("arm", elbow),
        ("forearm", plate),
        ("foot", ankle),
        ("head", neck),
        ("tray", desk),
        ("back", chest),
    ] {
        let at = match name {
            "forearm" => Placement::identity(),
            "back" => Placement::translation(vector(random, 0.3)),
            _ => place(random, 0.3),
        };
        own.frame(name, Some(joint), at);
    }
    own
}

/// The model, with no loops.
pub(crate) fn model(random: &mut Random, free: bool) -> Model {
    builder(random, free).build().unwrap()
}

/// The same, with a hand that holds the tray and a foot that is welded to the anchor.
pub(crate) fn looped(random: &mut Random) -> Model {
    let mut own = builder(random, true);
    let open = own.clone().build().unwrap();
    let frames = |names: [&str; 2]| names.map(|name| open.frame(name).unwrap());
    let places = [(); 2].map(|()| place(random, 0.1));
    own.close(Loop::connect("holds", frames(["hand", "tray"])).at(places));
    own.close(Loop::weld("stands", frames(["foot", "anchor"])));
    own.build().unwrap()
}

/// A mass on each frame, none on the third.
pub(crate) fn masses(model: &Model, random: &mut Random) -> Masses {
    let points: Vec<PointMass> = model
        .frame_ids()
        .map(|frame| PointMass {
            frame,
            at: vector(random, 0.2),
            mass: if frame.index() == 2 {
                0.0
            } else {
                random.within(0.1, 4.0)
            },
        })
        .collect();
    Masses::new(model, points).unwrap()
}

/// A joint that is locked, one that follows another backwards, one that is narrowed, a ball that is held.
pub(crate) fn map(model: &Model) -> ParameterMap {
    let joint = |name: &str| model.joint(name).unwrap();
    ParameterMap::builder(model)
        .with_locked(joint("chest"), 0.2)
        .with_coupled(joint("elbow"), joint("ankle/second"), -0.5, 1.2)
        .with_coupled(joint("slide"), joint("elbow"), 0.2, -0.1)
        .with_narrowed(joint("ankle/first"), Limits::new(-0.5, 3.0))
        .with_locked_ball(joint("neck"), [2.0, 0.3, -0.4, 0.1])
        .build()
        .unwrap()
}

/// Numbers within limits but for balls, whose quaternions are of any length.
pub(crate) fn configuration(model: &Model, random: &mut Random) -> Vec<f64> {
    let numbers = model.limits().map(|limits| {
        let (low, high) = (limits.lower.max(-2.0), limits.upper.min(2.0));
        limits.clamp(random.within(low, high))
    });
    numbers.collect()
}

pub(crate) fn frames(model: &Model, names: &[&str]) -> Vec<FrameId> {
    names
        .iter()
        .map(|name| model.frame(name).unwrap())
        .collect()
}
