//! Promise: a file with numbers of any size is rejected, or its arm reports only reached poses that independent
//! matrices confirm. If placements cannot resolve the tolerance, nothing is reached.

use kinopt::arm::{Arm, Base};
use kinopt::model::{Limits, Model};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::random::{Random, cases};
use support::urdf_matrices::{Tree, apart, placement};

/// File, base and tip.
const CHAINS: [(&str, &str, &str); 5] = [
    ("adept_cobra_s600", "base", "flange"),
    ("franka_panda", "base", "tool"),
    ("universal_ur5e", "base", "flange"),
    ("aldebaran_nao", "left_sole", "right_sole"),
    ("franka_panda", "base", "finger_right"),
];

/// Byte ranges of the numbers of joints: words of `xyz`, `rpy`, `lower`, `upper`, `multiplier` and `offset`.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let mut places = Vec::new();
    for name in ["xyz", "rpy", "lower", "upper", "multiplier", "offset"] {
        for (at, opening) in text.match_indices(&format!(" {name}=\"")) {
            let from = at + opening.len();
            let to = from + text[from..].find('"').unwrap();
            let mut word = from;
            for part in text[from..to].split(' ') {
                places.push((word, word + part.len()));
                word += part.len() + 1;
            }
        }
    }
    places
}

#[test]
fn reached_poses_are_confirmed_by_matrices() {
    let mut random = Random::split_mix(13);
    let (mut reached, mut built) = (0, 0);
    for case in cases(4000, 25) {
        let (file, base, tip) = CHAINS[case % CHAINS.len()];
        let mut text = std::fs::read_to_string(format!("../models/{file}.urdf")).unwrap();
        for _ in 0..1 + (random.unit() * 2.0) as usize {
            let places = numbers(&text);
            let (from, to) = places[(random.unit() * places.len() as f64) as usize];
            let size = 10f64.powf(random.unit() * [8.0, 18.0, 300.0][case % 3]);
            let number = if random.unit() < 0.4 { -size } else { size };
            text.replace_range(from..to, &number.to_string());
        }
        let Ok(robot) = Robot::parse(&text, "huge.urdf") else {
            continue;
        };
        let Ok(arm) = Arm::builder(&robot, base, tip).with_atlas(false).build() else {
            continue;
        };
        built += 1;
        let tree = Tree::parse(&text);
        for _ in 0..2 {
            let (truth, start) = (random.configuration(&arm), random.configuration(&arm));
            let at =
                |q: &[f64]| -> Vec<(&str, f64)> { arm.joints().zip(q.iter().copied()).collect() };
            // Target by independent matrices; the arm may reject it as no rigid motion.
            let target = tree.base_from_tip(base, tip, &at(&truth));
            let Ok(solution) = arm.solve(placement(&target), &start) else {
                continue;
            };
            let values = at(&solution.q);
            let found = tree.base_from_tip(base, tip, &values);
            let (metres, radians) = apart(&found, &target);
            if solution.reached {
                reached += 1;
                assert!(
                    metres <= 1.1e-6 && radians <= 1.1e-6,
                    "case {case}: {metres:e} m, {radians:e} rad off\n{values:?}\n{text}"
                );
            }
        }
    }
    assert!(built > 0 && reached > 0, "{built} {reached}");
}

/// A mimic joint's value is a sum of two parts. If they are huge and cancel, their rounding remains.
#[test]
fn cancelling_mimic_parts_keep_their_rounding() {
    let text = |ratio: f64| {
        format!(
            "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\
             <joint name=\"lead\" type=\"prismatic\"><parent link=\"a\"/><child link=\"b\"/>\
             <limit lower=\"0\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>\
             <joint name=\"follow\" type=\"prismatic\"><parent link=\"b\"/><child link=\"c\"/>\
             <axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>\
             <mimic joint=\"lead\" multiplier=\"{ratio}\" offset=\"{}\"/></joint></robot>",
            -ratio
        )
    };
    // At 1e12 the spacing of numbers is 1e-4.
    for (ratio, resolved) in [(1.0, true), (1e3, true), (1e12, false)] {
        let robot = Robot::parse(&text(ratio), "r.urdf").unwrap();
        let arm = Arm::new(&robot, "a", "c").unwrap();
        let target = arm.base_from_tool(&[1.0]).unwrap();
        let solution = arm.solve(target, &[1.0]).unwrap();
        assert_eq!(
            solution.reached,
            resolved,
            "{ratio}: {}",
            solution.explain()
        );
    }
}

/// The offset of a locked prismatic joint counts like one in the file: at 1e12 the spacing of numbers is 1e-4.
#[test]
fn huge_locked_value_keeps_its_rounding() {
    let mut builder = Model::builder("rail");
    let [x, _, z] = Vector3::UNITS;
    let none = Placement::identity();
    let rail = builder.prismatic("rail", None, none, x, Limits::new(-1e13, 1e13));
    let turn = builder.revolute("turn", Some(rail), none, z, Limits::new(-2.0, 2.0));
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    builder.frame("tip", Some(turn), link);
    let model = builder.build().unwrap();
    for (value, resolved) in [(1.0, true), (1e3, true), (1e12, false)] {
        let arm = Arm::builder(&model, Base::World, "tip").with_locked("rail", value);
        let arm = arm.build().unwrap();
        let target = arm.base_from_tool(&[0.5]).unwrap();
        let solution = arm.solve(target, &[0.5]).unwrap();
        let explanation = solution.explain();
        assert_eq!(solution.reached, resolved, "{value}: {explanation}");
    }
}
