//! Promise: so it is for what an arm misses, under every search and option, and for where followers, servos and
//! tracks go, step by step: within reach, out of reach, at rest there, back, and along limits.
#![allow(clippy::unwrap_used)]

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, Axis, HeldBy, Jump, PoseBounds, Search, ServoStatus};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;

use crate::digest::{Digest, Value, check};
use support::random::Random;

/// Targets out of reach, mostly: places of the arm further out.
fn missed(digest: &mut Digest, builder: ArmBuilder<'_>, random: &mut Random, count: usize) {
    let arm = builder.build().unwrap();
    for far in [1.3, 2.0].into_iter().take(count) {
        let start = random.configuration(&arm);
        let mut target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        target.translation = target.translation * far + Vector3::new(0.1, 0.2, 0.1);
        digest.solution(&arm.solve(target, &start).unwrap());
        for solution in arm.solve_all(target, &start).unwrap() {
            digest.solution(&solution);
        }
    }
}

fn misses() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(31));
    let [iiwa, cobra] = ["kuka_iiwa14", "adept_cobra_s600"].map(robot);
    let tool = Placement::translation(Vector3::new(0.03, -0.05, 0.4));
    let distinct = Search::Distinct {
        k: 3,
        distance: 0.3,
    };
    for (robot, n) in [(&iiwa, 7), (&cobra, 4)] {
        let builder = || {
            let builder = Arm::builder(robot, "base", "flange");
            builder.with_atlas(false).with_attempts(17)
        };
        let moves = [0.4, 0.5, 0.1, 0.6, 0.3, 0.4, 0.7];
        let everywhere = || builder().with_global_search_on_miss(true);
        for builder in [
            builder(),
            builder().with_search(Search::First),
            builder().with_search(Search::Nearest),
            builder().with_search(distinct),
            everywhere(),
            everywhere().with_search(Search::Nearest).with_tool(tool),
            everywhere().with_iterations(90).with_seed(4),
            builder().with_max_move(&moves[..n]),
            builder()
                .with_max_move(&moves[..n])
                .with_search(Search::Nearest),
            everywhere().with_max_move(&moves[..n]),
            builder().with_posture(&vec![0.1; n]),
            builder().with_tool(tool).with_metres_per_radian(0.1),
            builder().with_goal(PoseBounds::free_about(Axis::Z)),
            builder().with_goal(PoseBounds::position()),
        ] {
            missed(&mut digest, builder, &mut random, 1);
        }
    }
    digest.value()
}

/// Joints that follow one another go through the core.
fn misses_of_the_core() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(32));
    let nao = robot("aldebaran_nao");
    let builder = || Arm::builder(&nao, "left_sole", "right_sole");
    for builder in [
        builder().with_attempts(5).with_iterations(60),
        builder()
            .with_attempts(6)
            .with_global_search_on_miss(true)
            .with_seed(2),
        builder().with_attempts(6).with_search(Search::Nearest),
        builder().with_attempts(3).with_max_move(&[0.3; 11]),
    ] {
        missed(&mut digest, builder, &mut random, 1);
    }
    digest.value()
}

/// A way out, a rest there, a way back and a rest.
struct Course {
    start: Vec<f64>,
    targets: Vec<Placement<f64>>,
}

impl Course {
    /// So many metres towards `way` and back, in `steps` each, with a turn of the tool.
    fn new(arm: &Arm, start: &[f64], way: [f64; 3], steps: usize, rest: usize) -> Self {
        let from = arm.base_from_tool(start).unwrap();
        let out = (0..=steps).map(|k| k as f64 / steps as f64);
        let back = out.clone().map(|share| 1.0 - share);
        let still = |at: f64| std::iter::repeat_n(at, rest);
        let shares = out.chain(still(1.0)).chain(back).chain(still(0.0));
        let targets = shares.map(|share| {
            let mut target = from;
            target.translation += Vector3::from(way) * share;
            target
        });
        Self {
            start: start.to_vec(),
            targets: targets.collect(),
        }
    }
}

impl Digest {
    fn jump(&mut self, jump: Option<Jump>) {
        if let Some(jump) = jump {
            self.word(jump.step as u64);
            self.word(jump.joint as u64 + 16 * u64::from(jump.continuous));
            self.doubles([jump.distance]);
        }
    }

    fn follower(&mut self, arm: &Arm, course: &Course) {
        let mut follower = arm.follower(&course.start).unwrap();
        let mut solution = Solution::default();
        for target in &course.targets {
            let jump = follower.advance(*target, &mut solution).unwrap();
            self.jump(jump);
            self.solution(&solution);
        }
    }

    fn servo(&mut self, arm: &Arm, course: &Course, time_step: f64) {
        let mut servo = arm.servo(&course.start, time_step).unwrap();
        for target in &course.targets {
            let step = servo.step(*target).unwrap();
            self.doubles(step.q.iter().chain(step.velocity).copied());
            self.doubles([step.position_error, step.orientation_error]);
            self.word(match step.status {
                ServoStatus::OnTarget => 0,
                ServoStatus::SpeedLimited => 1,
                ServoStatus::Settling => 2,
                ServoStatus::Nearest => 3,
                _ => unreachable!("a new status"),
            });
            for (joint, by) in step.held() {
                self.text(joint);
                self.bytes(match by {
                    HeldBy::Limit(side) => format!("limit {side:?}"),
                    HeldBy::Speed(side) => format!("speed {side:?}"),
                    HeldBy::Acceleration(side) => format!("acceleration {side:?}"),
                    HeldBy::Outside(side) => format!("outside {side:?}"),
                    _ => unreachable!("a new bound"),
                });
            }
        }
    }

    fn track(&mut self, arm: &Arm, course: &Course) {
        let track = arm.track(&course.targets, &course.start).unwrap();
        track.solutions.iter().for_each(|s| self.solution(s));
        track.jumps.iter().for_each(|jump| self.jump(Some(*jump)));
    }
}

/// Robots, places that are near the edge of their reach or near limits, and ways from there.
const WAYS: [(&str, &[f64], [f64; 3]); 4] = [
    (
        "kuka_iiwa14",
        &[0.2, 0.8, -0.3, -0.7, 0.4, 0.6, 0.1],
        [0.5, 0.2, 0.1],
    ),
    (
        "kuka_iiwa14",
        &[2.9, 0.4, -2.9, -1.9, 0.4, 1.9, -2.9],
        [-0.3, 0.1, 0.3],
    ),
    (
        "universal_ur5e",
        &[0.2, -0.9, 0.7, -1.0, -1.2, 0.3],
        [0.4, 0.3, 0.1],
    ),
    (
        "adept_cobra_s600",
        &[1.7, 0.9, 0.18, 0.2],
        [-0.1, 0.2, 0.15],
    ),
];

/// Courses of one kind along all ways, by arms under `options`.
fn courses(
    steps: usize,
    options: impl for<'m> Fn(ArmBuilder<'m>, usize) -> ArmBuilder<'m>,
    mut go: impl FnMut(&mut Digest, &Arm, &Course),
) -> Value {
    let mut digest = Digest::new();
    for (name, start, way) in WAYS {
        let robot = robot(name);
        let builder = Arm::builder(&robot, "base", "flange");
        let arm = options(builder.with_atlas(false), start.len());
        let arm = arm.build().unwrap();
        let course = Course::new(&arm, start, way, steps, 3);
        go(&mut digest, &arm, &course);
    }
    digest.value()
}

#[test]
fn of_misses() {
    check(&[("arms that miss, counted", misses())]);
}

#[test]
fn of_misses_by_the_core() {
    check(&[("arms that miss by the core, counted", misses_of_the_core())]);
}

#[test]
fn of_followers() {
    let plain = courses(7, |builder, _| builder, Digest::follower);
    check(&[("followers, step by step", plain)]);
}

#[test]
fn of_followers_that_are_led_or_leap() {
    let led = courses(
        5,
        |builder, n| builder.with_posture(&vec![0.4; n]),
        Digest::follower,
    );
    let leaping = courses(
        2,
        |builder, _| {
            let builder = builder.with_global_search_on_miss(true);
            builder.with_attempts(10).with_iterations(40)
        },
        Digest::follower,
    );
    check(&[
        ("followers towards a posture", led),
        ("followers that may leap", leaping),
    ]);
}

#[test]
fn of_servos() {
    let servo = |time_step: f64| {
        move |digest: &mut Digest, arm: &Arm, course: &Course| digest.servo(arm, course, time_step)
    };
    check(&[
        (
            "servos, tick by tick",
            courses(14, |builder, _| builder, servo(0.04)),
        ),
        (
            "servos near their speeds",
            courses(
                4,
                |builder, _| builder.with_limit_avoidance(1.0),
                servo(0.004),
            ),
        ),
    ]);
}

#[test]
fn of_tracks() {
    check(&[(
        "tracks, step by step",
        courses(4, |builder, _| builder, Digest::track),
    )]);
}
