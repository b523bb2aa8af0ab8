//! Promise: the two-bone solver reaches targets exactly, with the elbow on the requested side, and reports unreachable
//! ones.

use kinopt::geometric::{Elbow, Fabrik, Geometric, Span, TwoBone, triangle};
use kinopt::ik::SolveError;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Orientation, Point, Ray};
use kinopt::{Problem, Solution};
use nalgebra as na;
use support::bones::humanoid;
use support::fault_tables::ExpectedError;
use support::random::Random;
use support::{planar_arm, planar_tip, vector};

fn problem(model: &Model, target: na::Vector3<f64>) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(Point::new(model.frame("tip").unwrap(), target));
    builder.build().unwrap()
}

fn solve(model: &Model, target: na::Vector3<f64>, elbow: Elbow, start: &[f64]) -> Solution {
    let solved = TwoBone::new(elbow).solve(&problem(model, target), start);
    solved.unwrap()
}

fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

#[test]
fn both_elbows_follow_the_law_of_cosines() {
    let mut random = Random::new(1);
    for _ in 0..100 {
        let [upper, lower] = [random.within(0.2, 2.0), random.within(0.2, 2.0)];
        let model = planar_arm(&[upper, lower], None);
        let nearest = f64::abs(upper - lower);
        let distance = random.within(nearest + 1e-3, upper + lower - 1e-3);
        let heading = random.within(-3.1, 3.1);
        let target = na::Vector3::new(heading.cos(), heading.sin(), 0.0) * distance;
        let start = [random.within(-3.0, 3.0), random.within(-3.0, 3.0)];
        let cosine = (distance.powi(2) - upper.powi(2) - lower.powi(2)) / (2.0 * upper * lower);
        for (elbow, sign) in [(Elbow::Positive, 1.0), (Elbow::Negative, -1.0)] {
            let solution = solve(&model, target, elbow, &start);
            assert!(solution.reached && solution.iterations == 1, "{elbow:?}");
            assert!((planar_tip(&[upper, lower], &solution.q) - target).norm() < 1e-12);
            let second = sign * cosine.acos();
            let (y, x) = (lower * second.sin(), lower.mul_add(second.cos(), upper));
            let first = heading - y.atan2(x);
            assert!(wrapped(solution.q[0] - first).abs() < 1e-9);
            assert!(wrapped(solution.q[1] - second).abs() < 1e-9);
        }
    }
}

#[test]
fn triangle_keeps_its_lengths_in_space() {
    let mut random = Random::new(2);
    for _ in 0..200 {
        let [upper, lower] = [random.within(0.1, 2.0), random.within(0.1, 2.0)];
        let (root, direction) = (random.vector(3.0), random.direction().into_inner());
        let distance = random.within(f64::abs(upper - lower), upper + lower);
        let (target, pole) = (root + direction * distance, random.vector(1.0));
        let solved = triangle(vector(root), [upper, lower], vector(target), vector(pole));
        assert_eq!(solved.span, Span::Within);
        let mid: na::Vector3<f64> = solved.mid.into();
        assert!(((mid - root).norm() - upper).abs() < 1e-9);
        assert!(((target - mid).norm() - lower).abs() < 1e-9);
        assert!((na::Vector3::from(solved.tip) - target).norm() < 1e-12);
        // The bend is towards the pole, in the plane of root, target and pole.
        let pole = pole - direction * direction.dot(&pole);
        assert!((mid - root).dot(&pole) >= 0.0);
        assert!((mid - root).dot(&direction.cross(&pole)).abs() < 1e-9);
        // The reported angles equal those between the bones.
        let turn = (target - mid).angle(&(mid - root));
        assert!((solved.turn - turn).abs() < 1e-7);
        assert!((solved.swing - (mid - root).angle(&direction)).abs() < 1e-7);
    }
}

#[test]
fn unreachable_target_stretches_or_folds() {
    let mut random = Random::new(3);
    for _ in 0..100 {
        let links = [random.within(0.2, 2.0), random.within(0.2, 2.0)];
        let model = planar_arm(&links, None);
        let heading = random.within(-3.1, 3.1);
        let along = na::Vector3::new(heading.cos(), heading.sin(), 0.0);
        let (stretched, folded) = (links[0] + links[1], f64::abs(links[0] - links[1]));
        let gap = random.within(0.05, 0.95) * folded;
        for (distance, miss) in [(stretched + gap, gap), (folded - gap, gap)] {
            for elbow in [Elbow::Positive, Elbow::Negative] {
                let solution = solve(&model, along * distance, elbow, &[0.4, 0.9]);
                assert!(!solution.reached);
                let tip = planar_tip(&links, &solution.q);
                assert!(((tip - along * distance).norm() - miss).abs() < 1e-9);
                let reported = solution.tasks().next().unwrap().position_error().unwrap();
                assert!((reported - miss).abs() < 1e-9);
                assert!(solution.explain().starts_with("Not reached"));
            }
        }
    }
}

#[test]
fn one_sided_joint_rejects_the_other_elbow() {
    let mut builder = Model::builder("hinge");
    let (z, link) = (Vector3::new(0.0, 0.0, 1.0), Vector3::new(1.0, 0.0, 0.0));
    let (turn, bend) = (Limits::new(-3.0, 3.0), Limits::new(0.0, 2.5));
    let link = Placement::translation(link);
    let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, turn);
    let elbow = builder.revolute("elbow", Some(shoulder), link, z, bend);
    builder.frame("tip", Some(elbow), link);
    let model = builder.build().unwrap();
    let target = na::Vector3::new(1.8, 0.3, 0.0);
    let solution = solve(&model, target, Elbow::Positive, &[0.0, 0.5]);
    assert!(solution.reached && solution.q[1] > 0.0);
    let solution = solve(&model, target, Elbow::Negative, &[0.0, 0.5]);
    assert!(!solution.reached);
    assert_eq!(solution.q[1].to_bits(), 0.0_f64.to_bits());
    assert!(solution.explain().contains("misses by"));
}

/// Turn, lift and bend, as on most robots: the elbow's sign selects one of two solutions. The pose's own sign gives the
/// pose, except for half a turn of the base.
#[test]
fn arm_on_a_rotating_base_is_solved() {
    let mut builder = Model::builder("arm");
    let [x, y, z] = Vector3::UNITS;
    let still = Placement::identity();
    let turn = builder.continuous("turn", None, Placement::translation(z * 0.3), z);
    let lift = builder.continuous("lift", Some(turn), still, y);
    let bend = builder.continuous("bend", Some(lift), Placement::translation(x * 0.5), y);
    let tip = builder.frame("tip", Some(bend), Placement::translation(x * 0.4));
    let model = builder.build().unwrap();
    let mut kinematics = ForwardKinematics::of_frames(&model, &[tip]).unwrap();
    let mut near = 0;
    for seed in 0..100 {
        let goal = model.random_configuration(seed);
        let target = kinematics.place(&goal).unwrap()[0].translation;
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, target));
        let problem = builder.build().unwrap();
        let start = model.random_configuration(seed + 500);
        for (elbow, sign) in [(Elbow::Positive, 1.0), (Elbow::Negative, -1.0)] {
            let solution = TwoBone::new(elbow).solve(&problem, &start).unwrap();
            assert!(solution.reached, "{seed} {elbow:?}: {}", solution.explain());
            let bent = wrapped(solution.q[2]);
            assert!(sign * bent >= 0.0);
            assert!((bent.abs() - wrapped(goal[2]).abs()).abs() < 1e-6);
        }
        // Of the two solutions, facing the target or leaning back, the one with the smaller rotation.
        let elbow = match wrapped(goal[2]) > 0.0 {
            true => Elbow::Positive,
            false => Elbow::Negative,
        };
        let nearby: Vec<f64> = goal.iter().map(|q| q + 0.02).collect();
        let solution = TwoBone::new(elbow).solve(&problem, &nearby).unwrap();
        let mut moves = solution.q.iter().zip(&nearby);
        near += usize::from(moves.all(|(a, b)| wrapped(a - b).abs() < 0.3));
    }
    assert!(near >= 90, "{near} of 100");
}

/// Arms and legs of the shipped humanoid: with the pole at the elbow of a pose, that pose is reached again, including
/// its elbow.
#[test]
fn rig_limb_follows_its_pole() {
    let rig = humanoid();
    let (skeleton, model) = (&rig.skeleton, rig.skeleton.model());
    let limits: Vec<Limits> = model.limits().collect();
    let limbs = [
        ["left_upper_arm", "left_forearm"],
        ["right_upper_arm", "right_forearm"],
        ["left_thigh", "left_shin"],
        ["right_thigh", "right_shin"],
    ];
    for (limb, seed) in limbs
        .iter()
        .flat_map(|limb| (0..25).map(move |seed| (limb, seed)))
    {
        let [upper, lower] = limb.map(|name| skeleton.bone(name).unwrap());
        let goal = model.random_configuration(seed);
        let pose = skeleton.pose(&goal).unwrap();
        let joints = [skeleton.joints(upper), skeleton.joints(lower)].concat();
        let map = ParameterMap::builder(model).with_only(&joints, &goal);
        let mut builder = Problem::builder(model);
        builder.parameters(map.build().unwrap());
        builder.add(Point::new(
            skeleton.tip(lower),
            pose.tip(skeleton, lower).unwrap(),
        ));
        let problem = builder.build().unwrap();
        let elbow = pose.tail(lower).unwrap();
        let start = model.random_configuration(seed + 1000);
        let solver = TwoBone::new(Elbow::Towards(elbow));
        let solution = solver.solve(&problem, &start).unwrap();
        let found = skeleton.pose(&solution.q).unwrap();
        assert!(
            (found.tail(lower).unwrap() - elbow).norm() < 1e-6,
            "{limb:?} {seed}"
        );
        assert!(solution.reached, "{limb:?} {seed}: {}", solution.explain());
        assert!(solution.q.iter().zip(&limits).all(|(&v, l)| l.contains(v)));
    }
}

#[test]
fn chain_without_two_bones_is_rejected() {
    let three = planar_arm(&[1.0, 1.0, 1.0], None);
    let target = na::Vector3::new(1.0, 0.0, 0.0);
    let two_bone = TwoBone::new(Elbow::Positive);
    let error = two_bone
        .solve(&problem(&three, target), &[0.0; 3])
        .unwrap_err();
    assert!(matches!(
        error,
        SolveError::NotTwoBones {
            bones: 3,
            tips: 1,
            ..
        }
    ));
    assert!(error.to_string().contains("planar arm"));

    let mut builder = Model::builder("slider");
    let (x, limits) = (Vector3::new(1.0, 0.0, 0.0), Limits::new(0.0, 1.0));
    let lift = builder.prismatic("lift", None, Placement::identity(), x, limits);
    builder.frame("tip", Some(lift), Placement::identity());
    let slider = builder.build().unwrap();
    two_bone
        .solve(&problem(&slider, target), &[0.0])
        .says("`lift` is prismatic");

    let two = planar_arm(&[1.0, 1.0], None);
    let tip = two.frame("tip").unwrap();
    let mut builder = Problem::builder(&two);
    builder.add(Ray::new(tip, [0.0; 3], [1.0, 0.0, 0.0]));
    two_bone
        .solve(&builder.build().unwrap(), &[0.0; 2])
        .says("ray");
    let mut builder = Problem::builder(&two);
    builder.add(Orientation::new(tip, Placement::<f64>::identity().rotation));
    let problem = builder.build().unwrap();
    Fabrik::default()
        .solve(&problem, &[0.0; 2])
        .says("orientation");
    assert!(Fabrik::default().solve(&problem, &[0.0]).is_err());
}
