//! Promise: so it is for what limits and kinds of joints say, for models that are refused and for names that are not
//! there, in every word.
#![allow(clippy::unwrap_used)]

use kinopt::model::{
    BallLimits, FrameRef, Joint, JointKind, JointRef, LengthUnit, Limits, Loop, Masses, Model,
    ModelBuilder, PointMass, UnknownName,
};
use kinopt::spatial::{Placement, Vector3};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{builder, model, place};

/// What limits say, and how they are put together.
fn ranges() -> Value {
    let mut digest = Digest::new();
    let ends = [
        f64::NEG_INFINITY,
        -1.5,
        -0.2,
        0.0,
        0.7,
        2.0,
        f64::INFINITY,
        f64::NAN,
    ];
    let mut all = Vec::new();
    for lower in ends {
        for upper in ends {
            all.push(Limits::new(lower, upper));
        }
    }
    for own in &all {
        digest.noted(&(own, own.is_locked(), own.is_valid()));
        digest.noted(&[-1.5, 0.0, 0.3, 9.0].map(|v| (own.contains(v), own.clamp(v))));
    }
    for pair in all.windows(9) {
        digest.noted(&pair[0].intersection(&pair[8]));
    }
    for kind in [
        JointKind::Fixed,
        JointKind::Revolute,
        JointKind::Continuous,
        JointKind::Prismatic,
        JointKind::Ball,
    ] {
        digest.text(kind.name());
        digest.noted(&(kind.moves(), kind.turns(), kind.slides(), kind.is_ball()));
        digest.noted(&(kind.coordinates(), kind.degrees_of_freedom()));
    }
    digest.noted(&[LengthUnit::Metres, LengthUnit::Own].map(LengthUnit::symbol));
    digest.value()
}

/// What builds a model on a revolute joint `first` and frames `tip` and `base`, and then goes wrong.
type Wrong = fn(&mut ModelBuilder, Joint);

fn refusals() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(113));
    let far = Placement::translation([1.0, 0.0, 0.0].into());
    let x = Vector3::UNITS[0];
    let whole = Limits::new(-1.0, 1.0);
    let limits: [BallLimits; 9] = [
        BallLimits::cone(0.0, whole),
        BallLimits::cone(3.2, whole),
        BallLimits::cone(1.0, Limits::new(1.0, -1.0)),
        BallLimits::cone(1.0, Limits::new(-4.0, 1.0)),
        BallLimits::cone(1.0, Limits::new(0.3, 1.0)).with_angle(0.2),
        BallLimits::within_angle(f64::NAN),
        BallLimits::elliptic(x * 2.0, [0.4, 0.5], whole),
        BallLimits::elliptic(Vector3::UNITS[1], [0.4, -0.5], whole),
        BallLimits::elliptic([f64::INFINITY, 1.0, 0.0], [0.4, 0.5], whole),
    ];
    for own in limits {
        let mut builder = Model::builder("balls");
        builder.ball("ball", None, far, x, Some(own));
        digest.refusal(builder.build());
    }
    let wrong: [Wrong; 14] = [
        |b, joint| {
            b.joint(joint);
        },
        |b, mut joint| {
            joint.name = "second".into();
            joint.limits = Limits::new(2.0, 1.0);
            b.joint(joint);
        },
        |b, mut joint| {
            joint.name = "second".into();
            joint.axis = [0.0, f64::NAN, 1.0].into();
            b.joint(joint);
        },
        |b, mut joint| {
            joint.name = "second".into();
            joint.axis = Vector3::zero();
            b.joint(joint);
        },
        |b, mut joint| {
            joint.name = "second".into();
            joint.parent_from_joint.rotation.x = Vector3::new(1.0, 0.5, 0.0);
            b.joint(joint);
        },
        |b, mut joint| {
            joint.name = "second".into();
            joint.ball = Some(BallLimits::cone(1.0, Limits::UNBOUNDED));
            b.joint(joint);
        },
        |b, joint| {
            let mut longer = Model::builder("longer");
            let [_, second] =
                ["a", "b"].map(|name| longer.fixed(name, joint.parent, joint.parent_from_joint));
            b.frame("lost", Some(second), joint.parent_from_joint);
        },
        |b, mut joint| {
            let id = b.fixed("a", None, joint.parent_from_joint);
            joint.parent = Some(id);
            *b = Model::builder("earlier");
            b.joint(joint);
        },
        |b, joint| {
            b.frame("tip", None, joint.parent_from_joint);
        },
        |b, mut joint| {
            joint.parent_from_joint.translation.y = f64::NAN;
            b.frame("nowhere", None, joint.parent_from_joint);
        },
        |b, _| b.configuration_order(Vec::new()),
        |b, _| {
            let base = b.clone().build().unwrap().frame("base").unwrap();
            b.close(Loop::weld("ring", [base, base]));
        },
        |b, _| {
            let names = ["tip", "base"].map(|name| b.clone().build().unwrap().frame(name).unwrap());
            b.close(Loop::connect("ring", names));
            b.close(Loop::connect("ring", names));
        },
        |b, joint| {
            let names = ["tip", "base"].map(|name| b.clone().build().unwrap().frame(name).unwrap());
            b.length_unit(LengthUnit::Own);
            let far = Placement::translation([0.0, 0.0, 40.0].into());
            b.close(Loop::connect("ring", names).at([far, joint.parent_from_joint]));
        },
    ];
    for wrong in wrong {
        let mut builder = Model::builder("wrong");
        let first = builder.revolute("first", None, far, x, whole);
        builder.frame("tip", Some(first), far);
        builder.frame("base", None, Placement::identity());
        let joint = builder.clone().build().unwrap().joints()[0].clone();
        wrong(&mut builder, joint);
        digest.refusal(builder.build());
    }
    // Slides that never meet, welds that do not turn.
    for (reach, kind) in [
        (0.1, "slide"),
        (0.9, "slide"),
        (3.0, "slide"),
        (0.1, "weld"),
    ] {
        let mut builder = Model::builder(kind);
        let slide = builder.prismatic("slide", None, far, x, Limits::new(-reach, 0.5 * reach));
        let a = builder.frame("a", Some(slide), place(&mut random, 0.0));
        let b = builder.frame("b", None, Placement::identity());
        builder.close(match kind {
            "weld" => Loop::weld("stuck", [a, b]),
            _ => Loop::connect("stuck", [b, a]),
        });
        digest.refusal(builder.build());
    }
    let order: Vec<_> = model(&mut random, true).moving_joints().to_vec();
    let mut unsorted = builder(&mut random, true);
    let mut order = order;
    order.dedup();
    order.swap(1, 2);
    unsorted.configuration_order(order.clone());
    digest.refusal(unsorted.build());
    order.swap(1, 2);
    order.rotate_left(4);
    let mut sorted = builder(&mut random, true);
    sorted.configuration_order(order);
    let model = sorted.build().unwrap();
    digest.doubles(model.random_configuration(3));
    let masses = |frame: usize, mass: f64, at: f64| {
        let frame = model.frame_ids().nth(frame).unwrap();
        Masses::new(
            &model,
            [PointMass {
                frame,
                mass,
                at: [0.0, at, 0.0].into(),
            }],
        )
    };
    for (frame, mass, at) in [
        (1, -1.0, 0.0),
        (1, f64::INFINITY, 0.0),
        (1, 1.0, f64::NAN),
        (0, 1.0, 0.0),
        (1, 0.0, 0.0),
    ] {
        digest.refusal(masses(frame, mass, at));
    }
    let foreign = PointMass {
        frame: model.frame_ids().nth(7).unwrap(),
        mass: 1.0,
        at: x,
    };
    digest.refusal(Masses::new(
        &Model::builder("other").build().unwrap(),
        [foreign],
    ));
    digest.value()
}

/// Names that are not there, and those that may have been meant.
fn names() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(114));
    let model = model(&mut random, true);
    for name in [
        "han",
        "hnad",
        "heads",
        "HEAD",
        "elbwo",
        "",
        "?",
        "waist",
        "base/",
        "shoulder_left",
        "zzz",
        "base rotation",
        "fo",
        "a",
    ] {
        digest.refusal(model.frame(name));
        digest.refusal(model.joint(name));
        digest.refusal(FrameRef::from(name).resolve(&model));
        digest.refusal(JointRef::from(name).resolve(&model));
        for valid in [
            &[][..],
            &["hand"],
            &["b"],
            &["left_hand", "right_hand", "hand_left"],
            &["ab", "ba", "aa"],
        ] {
            let own = UnknownName::new("bone", name, valid.iter().copied());
            digest.noted(&own.suggestions());
            digest.refusal(Err::<(), _>(own.clone()));
            digest.refusal(Err::<(), _>(own.with_note("of the left side")));
        }
        let many: Vec<String> = (0..14)
            .map(|k| format!("{}_{k}", ["hand", "head", "waist"][k % 3]))
            .collect();
        let own = UnknownName::new("bone", name, many.iter().map(String::as_str));
        digest.noted(&own.suggestions());
        digest.refusal(Err::<(), _>(own.clone()));
        digest.refusal(Err::<(), _>(own.with_note("of the left side")));
    }
    let other = Model::builder("other").build().unwrap();
    let frame = model.frame("hand").unwrap();
    let joint = model.joint("elbow").unwrap();
    digest.refusal(FrameRef::from(frame).resolve(&other));
    digest.refusal(JointRef::from(&joint).resolve(&other));
    digest.noted(&FrameRef::from(frame).resolve(&model).unwrap());
    digest.noted(&JointRef::from(joint).resolve(&model).unwrap());
    digest.noted(&model.joints_above(frame).collect::<Vec<_>>());
    digest.value()
}

#[test]
fn of_refused_models() {
    check(&[
        ("what limits and kinds of joints say", ranges()),
        ("models that are refused", refusals()),
        ("names that are not there", names()),
    ]);
}
