//! Promise: so it is for skeletons: compiled, posed, placed elsewhere, held where they are dragged, on hinges and on balls.
#![allow(clippy::unwrap_used)]

use kinopt::Skeleton;
use kinopt::io::rig::Rig;
use kinopt::model::{BallLimits, Limits, Model, ParameterMap};
use kinopt::skeleton::{
    BallSkeleton, Bone, BoneCone, BoneId, BonePlacements, Cones, Posing, SkeletonRoot,
};
use kinopt::spatial::{Matrix3, Placement, Quaternion, Vector3};
use support::random::Random;

use crate::animated::{check_single, rotation};
use crate::digest::{Digest, Value};

fn placed(random: &mut Random, size: f64) -> Placement<f64> {
    let turned = Quaternion::from(rotation(random).as_dquat().normalize());
    let at = [(); 3].map(|()| random.within(-size, size));
    Placement::new(turned.to_matrix(), at.into())
}

fn bone(name: &str, parent: Option<BoneId>, at: Placement<f64>) -> Bone {
    Bone {
        name: name.into(),
        parent,
        length: 0.4,
        model_from_rest: at,
        limits: [
            Limits::new(-1.0, 1.5),
            Limits::new(-0.5, 2.0),
            Limits::UNBOUNDED,
        ],
    }
}

const LOCKED: [Limits; 3] = [Limits {
    lower: 0.0,
    upper: 0.0,
}; 3];

/// A trunk with limbs of several lengths, one of bones without length, one that is locked.
fn body(random: &mut Random) -> Skeleton {
    let mut builder = Skeleton::builder("body");
    let mut add = |name: &str, parent: Option<BoneId>, change: fn(&mut Bone)| {
        let mut own = bone(name, parent, placed(random, 1.0));
        change(&mut own);
        builder.add(own)
    };
    let root = add("root", None, |own| own.limits = LOCKED);
    let hips = add("hips", Some(root), |_| {});
    let back = add("back", Some(hips), |_| {});
    let chest = add("chest", Some(back), |own| own.length = 0.0);
    let neck = add("neck", Some(chest), |_| {});
    add("head", Some(neck), |own| own.length = 0.0);
    let mut limb = |names: [&str; 4], on: BoneId| {
        let [a, b, c, d] = names;
        let first = add(a, Some(on), |own| own.length = 0.9);
        let second = add(b, Some(first), |own| own.length = 0.0);
        let third = add(c, Some(second), |own| own.length = 1.1);
        add(d, Some(third), |own| own.length = 0.05);
        // A finger on the other side, and a bone that cannot move.
        add(&format!("{d}/tip"), Some(third), |own| own.length = 0.02);
        add(&format!("{a} rigid"), Some(first), |own| {
            own.limits = LOCKED
        });
    };
    limb(["thigh", "knee", "shin", "foot"], hips);
    limb(["thigh2", "knee2", "shin2", "foot2"], hips);
    limb(["arm", "elbow", "fore", "hand"], chest);
    limb(["arm2", "elbow2", "fore2", "hand2"], chest);
    add("prop", None, |own| own.limits[1] = Limits::new(0.0, 1.0));
    read_again(&builder.build().unwrap())
}

fn read_again(skeleton: &Skeleton) -> Skeleton {
    // As serde reads it again.
    let text = serde_json::to_string(skeleton).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn add_model(digest: &mut Digest, model: &Model) {
    digest.text(model.name());
    digest.debug((model.length_unit().symbol(), model.joints(), model.frames()));
    digest.debug((
        model.moving_joints(),
        model.free_joints(),
        model.limits().collect::<Vec<_>>(),
    ));
    digest.doubles(model.neutral());
}

fn add_placement(digest: &mut Digest, placed: &Placement<f64>) {
    digest.doubles(
        [placed.rotation.x, placed.rotation.y, placed.rotation.z]
            .into_iter()
            .flat_map(|v| v.to_array()),
    );
    digest.doubles(placed.translation.to_array());
}

fn add_pose(digest: &mut Digest, skeleton: &Skeleton, pose: &BonePlacements) {
    pose.model_from_bone
        .iter()
        .for_each(|own| add_placement(digest, own));
    for bone in skeleton.bone_ids() {
        digest.doubles(pose.tail(bone).unwrap().to_array());
        digest.doubles(pose.tip(skeleton, bone).unwrap().to_array());
    }
    let skin: Vec<_> = pose.skinning_transforms(skeleton).collect();
    skin.iter().for_each(|own| add_placement(digest, own));
}

fn hinges() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(211));
    let body = body(&mut random);
    add_model(&mut digest, body.model());
    digest.doubles([body.size()]);
    digest.debug((body.angles(), body.bone_at(99)));
    for bone in body.bone_ids() {
        digest.debug((body.tail(bone), body.tip(bone), body.joints(bone)));
        let own = &body.bones()[bone.index()];
        digest.doubles(
            own.rest_tail()
                .to_array()
                .into_iter()
                .chain(own.rest_tip().to_array()),
        );
    }
    for frame in body.model().frame_ids() {
        digest.debug(body.bone_of_frame(frame));
    }
    let scene = placed(&mut random, 3.0);
    let elsewhere = body.placed(scene).unwrap();
    digest.json(&elsewhere);
    let mut posing = Posing::new(&body);
    for _ in 0..3 {
        let q: Vec<f64> = (0..body.angles())
            .map(|_| random.within(-3.0, 3.0))
            .collect();
        let pose = posing.pose(&q).unwrap().clone();
        assert_eq!(body.pose(&q).unwrap(), pose);
        add_pose(&mut digest, &body, &pose);
        add_pose(&mut digest, &elsewhere, &elsewhere.pose(&q).unwrap());
        add_pose(&mut digest, &body, &pose.placed(scene));
    }
    digest.doubles([Skeleton::new("none", vec![]).unwrap().size()]);
    digest.value()
}

fn held() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(212));
    let figures = [
        body(&mut random),
        Rig::read("../models/humanoid/humanoid.json")
            .unwrap()
            .skeleton,
        Rig::read("../models/robot-arm/robot-arm.json")
            .unwrap()
            .skeleton,
    ];
    for body in &figures {
        let all: Vec<BoneId> = body.bone_ids().collect();
        let mut drags: Vec<Vec<BoneId>> = all.iter().map(|&bone| vec![bone]).collect();
        drags.push(vec![]);
        drags.extend((0..6).map(|_| (0..3).map(|_| all[random.below(all.len())]).collect()));
        for dragged in drags {
            let holds = body.holds(&dragged);
            digest.debug(&holds);
            let q = vec![0.0; body.angles()];
            match holds.parameters(body, &q) {
                Ok(map) => {
                    digest.doubles(map.lower().iter().chain(map.upper()).copied());
                    digest.debug((map.variables(), map.sources()));
                }
                Err(error) => digest.text(error.to_string()),
            }
        }
    }
    let holds = figures[0].holds(&[figures[0].bone("hand").unwrap()]);
    digest.refused(holds.parameters(&figures[0], &[0.0; 2]));
    digest.refused(holds.parameters(&figures[0], &vec![f64::NAN; figures[0].angles()]));
    digest.refused(holds.parameters(&figures[0], &vec![3.0; figures[0].angles()]));
    digest.value()
}

fn balls() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(213));
    let body = body(&mut random);
    let cone = |swing| BallLimits::cone(swing, Limits::new(-0.5, 0.75));
    let about = BallLimits::elliptic([0.0, 1.0, 1.0], [0.5, 1.0], Limits::UNBOUNDED);
    let cones = Cones::from([
        ("arm".to_owned(), BoneCone::new(cone(1.0))),
        (
            "elbow".to_owned(),
            BoneCone::about([0.0, 0.0, 2.0], cone(0.01)),
        ),
        ("chest".to_owned(), BoneCone::new(about)),
        (
            "head".to_owned(),
            BoneCone::new(BallLimits::within_angle(1.25)),
        ),
    ]);
    let bounds = [
        Limits::new(-1.0, 2.0),
        Limits::UNBOUNDED,
        Limits::new(0.0, 0.5),
    ];
    for root in [
        SkeletonRoot::Fixed,
        SkeletonRoot::FREE,
        SkeletonRoot::Free { bounds },
    ] {
        let figure = BallSkeleton::new(body.clone(), &cones, root).unwrap();
        add_model(&mut digest, figure.model());
        for bone in body.bone_ids() {
            digest.debug((
                figure.joint(bone),
                figure.joints(bone),
                figure.is_free(bone),
            ));
            digest.debug((figure.tail(bone), figure.tip(bone)));
        }
        digest.debug(figure.bone("hand").unwrap());
        digest.text(figure.skeleton().model().name());
        let mut posing = figure.posing();
        for seed in 0..2 {
            let mut q = figure.model().neutral();
            q.iter_mut()
                .for_each(|value| *value += random.within(-0.4, 0.4));
            figure.model().normalise(&mut q).unwrap();
            let pose = posing.pose(&q).unwrap().clone();
            assert_eq!(figure.pose(&q).unwrap(), pose);
            add_pose(&mut digest, &body, &pose);
            let dragged = body.bone(["hand", "foot2"][seed]).unwrap();
            let map = ParameterMap::builder(figure.model());
            let map = figure
                .hold(map, &body.holds(&[dragged]), &q)
                .build()
                .unwrap();
            digest.debug((map.variables(), map.sources()));
            digest.doubles(map.lower().iter().chain(map.upper()).copied());
        }
        digest.refused(figure.bone("hnad"));
        digest.refused(figure.pose(&[0.0; 3]));
        let map = ParameterMap::builder(figure.model());
        digest.refused(figure.hold(map, &body.holds(&[]), &[0.0; 3]).build());
    }
    let with = |name: &str, cone: BoneCone, root| {
        let cones = Cones::from([(name.to_owned(), cone)]);
        BallSkeleton::new(body.clone(), &cones, root)
    };
    let own = BoneCone::new(cone(1.0));
    digest.refused(with("amr", own, SkeletonRoot::Fixed));
    digest.refused(with("root", own, SkeletonRoot::Fixed));
    digest.refused(with("hips", own, SkeletonRoot::FREE));
    digest.refused(with(
        "arm",
        BoneCone::about([0.0; 3], cone(1.0)),
        SkeletonRoot::Fixed,
    ));
    digest.refused(with("arm", BoneCone::new(cone(-1.0)), SkeletonRoot::Fixed));
    let none = [Limits::new(1.0, 0.0); 3];
    digest.refused(with("arm", own, SkeletonRoot::Free { bounds: none }));
    digest.value()
}

fn refused() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(214));
    let own = body(&mut random);
    let second = own.bone_at(1).unwrap();
    let still = Placement::identity();
    let mut odd = |change: &dyn Fn(&mut Vec<Bone>)| {
        let mut bones = vec![
            bone("a", None, still),
            bone("b", None, placed(&mut random, 1.0)),
        ];
        change(&mut bones);
        match Skeleton::new("odd", bones) {
            Ok(skeleton) => add_model(&mut digest, skeleton.model()),
            Err(error) => digest.text(error.to_string()),
        }
    };
    odd(&|bones| bones[0].parent = Some(second));
    odd(&|bones| bones[1].name = "a".into());
    odd(&|bones| bones[1].name = "a/tip".into());
    odd(&|bones| bones[1].name = "a/bend".into());
    odd(&|bones| bones[1].length = -1.0);
    odd(&|bones| bones[1].length = f64::INFINITY);
    for angle in 0..3 {
        odd(&|bones| bones[1].limits[angle] = Limits::new(1.0, 0.5));
    }
    odd(&|bones| bones[0].limits[0] = Limits::new(f64::NAN, 0.5));
    odd(&|bones| bones[1].model_from_rest.rotation.x.x += 1e-5);
    odd(&|bones| bones[1].model_from_rest.rotation.x.x += 1e-7);
    odd(&|bones| bones[1].model_from_rest.translation.z = f64::NAN);
    let mirror = Matrix3::from_columns(
        [-1.0, 0.0, 0.0].into(),
        Vector3::UNITS[1],
        Vector3::UNITS[2],
    );
    odd(&|bones| bones[1].model_from_rest.rotation = mirror);
    digest.refused(own.placed(Placement::new(mirror, Vector3::zero())));
    digest.refused(own.bone("hnad"));
    digest.refused(own.pose(&[0.0; 3]));
    digest.refused(own.pose(&vec![f64::NAN; own.angles()]));
    let small = Skeleton::new("small", vec![bone("a", None, still)]).unwrap();
    let pose = small.pose(&[0.1, 0.2, 0.3]).unwrap();
    digest.refused(pose.tail(second));
    digest.refused(pose.tip(&small, second));
    digest.refused(pose.tip(&own, second));
    let text = serde_json::to_string(&small)
        .unwrap()
        .replacen("0.4", "-0.4", 1);
    digest.refused(serde_json::from_str::<Skeleton>(&text));
    digest.value()
}

#[test]
fn of_skeletons() {
    check_single(&[
        ("skeletons on hinges", hinges()),
        ("skeletons, held where they are dragged", held()),
        ("skeletons on balls", balls()),
        ("skeletons: what is refused", refused()),
    ]);
}
