//! Promise: limbs without a shared variable are restarted separately. Reachable targets of all limbs are reached as
//! often as those of each limb alone.

use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::problem::Problem;
use kinopt::robot::Robot;
use kinopt::task::FramePose;
use kinopt::{Solver, Workspace};

const ARMS: [&str; 4] = ["a", "b", "c", "d"];

/// Four UR5e arms side by side on one link.
fn robot() -> Robot {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/universal_ur5e.urdf");
    let text = std::fs::read_to_string(file).unwrap();
    let start = text.find("<robot").unwrap();
    let inner = &text[start + text[start..].find('>').unwrap() + 1..text.find("</robot>").unwrap()];
    let arms: String = ARMS
        .iter()
        .enumerate()
        .map(|(k, arm)| {
            let arm_text = inner
                .replace("name=\"", &format!("name=\"{arm}_"))
                .replace("link=\"", &format!("link=\"{arm}_"));
            format!(
                "{arm_text}<joint name=\"{arm}_mount\" type=\"fixed\"><parent link=\"torso\"/><child link=\"{arm}_base\"/>\
                 <origin xyz=\"{k} 0 0\"/></joint>"
            )
        })
        .collect();
    Robot::parse(
        &format!("<robot name=\"four\"><link name=\"torso\"/>{arms}</robot>"),
        "four.urdf",
    )
    .unwrap()
}

#[test]
fn independent_limbs_reach_as_often_as_alone() {
    let robot = robot();
    let model = robot.model();
    let tips = ARMS.map(|arm| model.frame(&format!("{arm}_flange")).unwrap());
    let mut kinematics = ForwardKinematics::of_frames(model, &tips).unwrap();
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(12));
    let mut workspace = Workspace::new();
    let solved = |frames: &[usize],
                  q: &[f64],
                  kinematics: &mut ForwardKinematics,
                  workspace: &mut Workspace| {
        let placed = kinematics.place(q).unwrap();
        let mut tasks = Problem::builder(model);
        for &k in frames {
            tasks.add(FramePose::new(tips[k], placed[k]));
        }
        let problem = tasks.build().unwrap();
        solver
            .solve(&problem, &model.neutral(), workspace)
            .unwrap()
            .reached
    };
    let mut missed = [0, 0];
    for seed in 0..60 {
        let q = robot.random_configuration(seed);
        missed[0] += usize::from(!solved(&[0, 1, 2, 3], &q, &mut kinematics, &mut workspace));
        let mut alone = (0..4).map(|k| solved(&[k], &q, &mut kinematics, &mut workspace));
        missed[1] += usize::from(!alone.all(|reached| reached));
    }
    assert!(
        missed[0] <= missed[1] + 1,
        "{missed:?} of 60 missed together and one by one"
    );
}
