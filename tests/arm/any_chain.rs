//! Promise: chains between any two frames of a tree are solved. This includes mimic, prismatic and continuous joints, a
//! base in another branch, tools, and subsets of joints. Independent kinematics of the file check results to 1e-6 m and
//! 1e-6 rad.

use kinopt::arm::{Arm, ArmBuilder, ArmError, Base, Search};
use kinopt::robot::Robot;
use support::arms::within_limits;
use support::fault_tables::ExpectedError;
use support::random::Random;
use support::urdf_matrices::{IDENTITY, Matrix, Tree, about, apart, placement, product};

/// The elbow has a mimic joint of ratio −½ in the next link. The camera pan is in another branch.
const COUPLED: &str = r#"<robot name="coupled">
  <link name="world"/><link name="mount"/><link name="upper"/><link name="fore"/><link name="knee"/>
  <link name="quill"/><link name="spun"/><link name="bracket"/><link name="palm"/><link name="hand"/>
  <link name="neck"/><link name="camera"/>
  <joint name="mounted" type="fixed"><parent link="world"/><child link="mount"/>
    <origin xyz="0.1 -0.2 0.3" rpy="0.3 -0.2 0.7"/></joint>
  <joint name="shoulder" type="revolute"><parent link="mount"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-2.8" upper="2.9" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.05 0 0.3"/><axis xyz="0 3 0"/>
    <limit lower="-2" upper="1.9" effort="1" velocity="1"/></joint>
  <joint name="follower" type="revolute"><parent link="fore"/><child link="knee"/>
    <origin xyz="0.35 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-0.7" upper="1.1" effort="1" velocity="1"/>
    <mimic joint="elbow" multiplier="-0.5" offset="0.2"/></joint>
  <joint name="lift" type="prismatic"><parent link="knee"/><child link="quill"/>
    <origin xyz="0.1 0 0" rpy="0 1.2 0"/><axis xyz="0 0 2"/>
    <limit lower="0.05" upper="0.45" effort="1" velocity="1"/></joint>
  <joint name="roll" type="continuous"><parent link="quill"/><child link="spun"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="bent" type="fixed"><parent link="spun"/><child link="bracket"/>
    <origin xyz="0.02 0.01 0.1" rpy="1.1 0.4 -0.3"/></joint>
  <joint name="pitch" type="revolute"><parent link="bracket"/><child link="palm"/>
    <axis xyz="0 1 0"/><limit lower="-1.8" upper="1.8" effort="1" velocity="1"/></joint>
  <joint name="yaw" type="revolute"><parent link="palm"/><child link="hand"/>
    <origin xyz="0 0 0.08"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="pan" type="revolute"><parent link="world"/><child link="neck"/>
    <origin xyz="-0.3 0.2 0.9" rpy="0 0.5 0"/><axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="tilted" type="fixed"><parent link="neck"/><child link="camera"/>
    <origin xyz="0.05 0 0.02" rpy="-1.5 0 -1.5"/></joint>
</robot>"#;

/// Variant in which the wrist's yaw is a mimic joint of the pan.
fn yaw_follows_pan() -> String {
    let limit = "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>";
    COUPLED.replace(
        limit,
        &format!("{limit}<mimic joint=\"pan\" multiplier=\"2\"/>"),
    )
}

/// A chain of a file with a tool at its tip.
struct Case<'a> {
    tree: &'a Tree,
    base: &'a str,
    tip: &'a str,
    tip_from_tool: Matrix,
    /// Locked joints.
    held: &'a [(&'a str, f64)],
}

impl Case<'_> {
    fn base_from_tool(&self, arm: &Arm, q: &[f64]) -> Matrix {
        let mut values: Vec<_> = arm.joints().zip(q.iter().copied()).collect();
        values.extend(self.held);
        let tip = self.tree.base_from_tip(self.base, self.tip, &values);
        product(&tip, &self.tip_from_tool)
    }

    /// Solves random poses and checks every reported value by independent kinematics.
    fn all_solved(&self, builder: &ArmBuilder<'_>, searches: &[Search], count: usize) {
        for &search in searches {
            let mut builder = builder.clone().with_search(search);
            if !SINGLE_SOLUTION_SEARCHES.contains(&search) {
                // Building an atlas takes longer than these few solves.
                builder = builder.with_atlas(false);
            }
            let arm = builder.build().unwrap();
            let mut random = Random::split_mix(21);
            for _ in 0..count {
                let truth = random.configuration(&arm);
                let target = self.base_from_tool(&arm, &truth);
                let start = random.configuration(&arm);
                let solution = arm.solve(placement(&target), &start).unwrap();
                assert!(solution.reached, "{search:?} {truth:?} {start:?}");
                let mut found = vec![solution.q];
                if search == Search::Nearest {
                    let all = arm.solve_all_from(placement(&target), &start).unwrap();
                    assert!(!all.solutions.is_empty(), "{truth:?} {start:?}");
                    found.extend(all.solutions.into_iter().map(|solution| solution.q));
                }
                for q in &found {
                    let (metres, radians) = apart(&self.base_from_tool(&arm, q), &target);
                    assert!(
                        metres <= 1e-6 && radians <= 1e-6,
                        "{search:?} {metres:e} {radians:e} {truth:?} {start:?}"
                    );
                    assert!(within_limits(&arm, q));
                }
            }
        }
    }
}

const ALL_SEARCHES: [Search; 3] = [Search::Start, Search::First, Search::Nearest];
const SINGLE_SOLUTION_SEARCHES: [Search; 2] = [Search::Start, Search::First];

fn plain<'a>(tree: &'a Tree, base: &'a str, tip: &'a str) -> Case<'a> {
    Case {
        tree,
        base,
        tip,
        tip_from_tool: IDENTITY,
        held: &[],
    }
}

#[test]
fn mimic_joint_inside_the_chain_is_solved() {
    let robot = Robot::parse(COUPLED, "coupled.urdf").unwrap();
    let robot = robot.with_mimic_limits().unwrap();
    let tree = Tree::parse(COUPLED);
    let builder = Arm::builder(&robot, "mount", "hand");
    let arm = builder.clone().with_atlas(false).build().unwrap();
    let free = ["shoulder", "elbow", "lift", "roll", "pitch", "yaw"];
    assert_eq!(arm.joints().collect::<Vec<_>>(), free);
    // -0.7 <= 0.2 - elbow / 2 <= 1.1 narrows the elbow to [-1.8, 1.8].
    let elbow = arm.limits().nth(1).unwrap();
    assert!((elbow.lower + 1.8).abs() < 1e-15 && (elbow.upper - 1.8).abs() < 1e-15);
    plain(&tree, "mount", "hand").all_solved(&builder, &ALL_SEARCHES, 6);
}

#[test]
fn source_joint_outside_the_chain_is_solved() {
    let text = yaw_follows_pan();
    let robot = Robot::parse(&text, "coupled.urdf").unwrap();
    let tree = Tree::parse(&text);
    let builder = Arm::builder(&robot, "world", "hand");
    let arm = builder.clone().with_atlas(false).build().unwrap();
    let mut free: Vec<_> = arm.joints().collect();
    free.sort_unstable();
    assert_eq!(free, ["elbow", "lift", "pan", "pitch", "roll", "shoulder"]);
    plain(&tree, "world", "hand").all_solved(&builder, &SINGLE_SOLUTION_SEARCHES, 6);
    // In a configuration of the whole robot mimic joints follow their source joints.
    let q = [0.3, 0.4, 0.2, 1.0, 0.1, 0.25];
    let mut all = robot.model().neutral();
    arm.configuration(&q, &mut all).unwrap();
    let at = |name: &str| {
        let id = robot.model().joint(name).unwrap();
        all[robot.model().coordinate(id).unwrap()]
    };
    assert_eq!(at("follower"), 0.2 - 0.5 * at("elbow"));
    assert_eq!(at("yaw"), 2.0 * at("pan"));
}

#[test]
fn base_in_another_branch_is_solved() {
    for text in [COUPLED, &yaw_follows_pan()] {
        let robot = Robot::parse(text, "coupled.urdf").unwrap();
        let tree = Tree::parse(text);
        let builder = Arm::builder(&robot, "camera", "hand");
        plain(&tree, "camera", "hand").all_solved(&builder, &SINGLE_SOLUTION_SEARCHES, 4);
        let builder = Arm::builder(&robot, "palm", "camera");
        plain(&tree, "palm", "camera").all_solved(&builder, &SINGLE_SOLUTION_SEARCHES, 4);
    }
}

#[test]
fn tool_on_any_frame_is_solved() {
    let file = "../models/franka_panda.urdf";
    let (robot, tree) = (Robot::read(file).unwrap(), Tree::read(file));
    let mut tool = about([1.0, -2.0, 0.5], 0.8);
    (tool[0][3], tool[1][3], tool[2][3]) = (0.12, -0.05, 0.2);
    let links: Vec<String> = (robot.model().frames().iter())
        .map(|frame| frame.name.clone())
        .collect();
    let mut arms = 0;
    for tip in &links {
        let builder = Arm::builder(&robot, "base", tip).with_atlas(false);
        let Ok(_) = builder.clone().build() else {
            continue;
        };
        arms += 1;
        let case = Case {
            tip_from_tool: tool,
            ..plain(&tree, "base", tip)
        };
        // The search without an atlas is slower but builds faster.
        let builder = builder.with_tool(placement(&tool));
        case.all_solved(&builder, &[Search::Start], 4);
    }
    // Every link except the base can be a tip.
    assert_eq!(arms, links.len() - 1);
}

#[test]
fn subset_of_the_joints_is_solved() {
    let file = "../models/franka_panda.urdf";
    let (robot, tree) = (Robot::read(file).unwrap(), Tree::read(file));
    // Six joints remain; the locked one is not at 0.
    let builder = Arm::builder(&robot, "base", "flange");
    let held = [("joint3", 0.4)];
    let builder = builder.with_locked("joint3", 0.4);
    let arm = builder.clone().with_atlas(false).build().unwrap();
    assert_eq!(arm.joint_count(), 6);
    let case = Case {
        held: &held,
        ..plain(&tree, "base", "flange")
    };
    case.all_solved(&builder, &ALL_SEARCHES, 4);
    // Three joints remain: few poses are reachable, and those are solved.
    let mut q = robot.model().neutral();
    let held = [
        ("joint1", 0.2),
        ("joint3", -0.6),
        ("joint5", 1.0),
        ("joint6", 2.2),
    ];
    for (name, value) in held {
        let id = robot.model().joint(name).unwrap();
        q[robot.model().coordinate(id).unwrap()] = value;
    }
    let free = ["joint2", "joint4", "joint7"];
    let builder = Arm::builder(&robot, "base", "flange");
    let builder = builder.with_only(free, &q);
    let arm = builder.clone().with_atlas(false).build().unwrap();
    assert_eq!(arm.joints().collect::<Vec<_>>(), free);
    let case = Case {
        held: &held,
        ..plain(&tree, "base", "flange")
    };
    case.all_solved(&builder, &SINGLE_SOLUTION_SEARCHES, 8);
    let mut all = vec![0.0; robot.model().degrees_of_freedom()];
    arm.configuration(&[0.5, -1.0, 0.3], &mut all).unwrap();
    for (name, value) in held
        .iter()
        .chain(&[("joint2", 0.5), ("joint4", -1.0), ("joint7", 0.3)])
    {
        let id = robot.model().joint(name).unwrap();
        assert_eq!(all[robot.model().coordinate(id).unwrap()], *value, "{name}");
    }
}

#[test]
fn prismatic_chain_is_solved() {
    let mut text = String::from("<robot name=\"gantry\"><link name=\"l0\"/>");
    for (k, axis) in ["1 0 0", "0 1 0", "0 0 -1"].iter().enumerate() {
        text.push_str(&format!(
            "<link name=\"l{}\"/><joint name=\"j{k}\" type=\"prismatic\"><parent link=\"l{k}\"/>\
             <child link=\"l{}\"/><origin xyz=\"0.1 0.2 0.3\" rpy=\"0.2 0 0.1\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-{k}.5\" upper=\"7\" effort=\"1\" velocity=\"1\"/></joint>",
            k + 1,
            k + 1
        ));
    }
    text.push_str("</robot>");
    let robot = Robot::parse(&text, "gantry.urdf").unwrap();
    let builder = Arm::builder(&robot, "l0", "l3");
    plain(&Tree::parse(&text), "l0", "l3").all_solved(&builder, &ALL_SEARCHES, 6);
}

#[test]
fn invalid_arms_are_named_in_errors() {
    let robot = Robot::parse(COUPLED, "coupled.urdf").unwrap();
    let error = Arm::new(&robot, "world", "mount").unwrap_err();
    assert!(
        matches!(&error, ArmError::NoFreeJoint { base, tip } if base == "world" && tip == "mount")
    );
    Arm::new(&robot, "world", "hook").says("hook | camera");
    let builder = || Arm::builder(&robot, "world", "hand");
    builder()
        .with_locked("wrist", 0.0)
        .build()
        .says("wrist | shoulder");
    // The first of several is named.
    let several = builder().with_locked("knee", 0.0).with_locked("wrist", 0.0);
    let error = several.build().unwrap_err().to_string();
    assert!(
        error.contains("`knee`") && !error.contains("`wrist`"),
        "{error}"
    );
    for value in [9.0, f64::NAN, f64::INFINITY] {
        let error = builder().with_locked("lift", value);
        error.build().says("lift");
    }
    let twice = builder().with_locked("lift", 0.1);
    let twice = twice.with_locked("lift", 0.2).build();
    let error = twice.unwrap_err().to_string();
    assert_eq!(error, "joint `lift` is locked twice");
    builder()
        .with_only(["lift", "wrist"], &[])
        .build()
        .says("wrist");
}

/// Frames and joints by id equal those by name, and the world equals the frame of that name.
#[test]
fn ids_and_world_equal_names() {
    let robot = Robot::parse(COUPLED, "coupled.urdf").unwrap();
    let model = robot.model();
    let [world, hand] = ["world", "hand"].map(|name| model.frame(name).unwrap());
    let lift = model.joint("lift").unwrap();
    let named = Arm::builder(&robot, "world", "hand").with_locked("lift", 0.1);
    let by_id = Arm::builder(&robot, world, hand).with_locked(lift, 0.1);
    let of_world = Arm::builder(&robot, Base::World, hand).with_locked(lift, 0.1);
    let joints = named.joints().unwrap();
    let q = vec![0.3; joints.len()];
    let arm = named.with_atlas(false).build().unwrap();
    assert_eq!(arm.joint_ids(), joints);
    let target = arm.base_from_tool(&q).unwrap();
    let solution = arm.solve(target, &vec![0.0; q.len()]).unwrap();
    for same in [by_id, of_world] {
        assert_eq!(same.joints().unwrap(), joints);
        let same = same.with_atlas(false).build().unwrap();
        assert_eq!(same.base_from_tool(&q).unwrap(), target);
        let again = same.solve(target, &vec![0.0; q.len()]).unwrap();
        assert_eq!(again.q, solution.q);
    }
    // An id of a larger model is reported like an unknown name.
    let larger = Robot::read("../models/aldebaran_nao.urdf").unwrap();
    let foreign_frame = larger.model().frame_ids().last().unwrap();
    Arm::new(&robot, Base::World, foreign_frame).says("camera");
    let foreign_frame = larger.model().joint_ids().last().unwrap();
    let builder = Arm::builder(&robot, Base::World, "hand").with_only([foreign_frame], &[]);
    builder.joints().says("shoulder");
}
