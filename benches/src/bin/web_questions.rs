//! Native version of the queries of `web/speed.js`: poses of the Panda, a drag of the humanoid, its skin. `web/speed`
//! runs both and prints a comparison; `KINOPT_PORTABLE=1` selects the code without AVX2 and FMA.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;
use std::time::Instant;

use kinopt::Problem;
use kinopt::arm::{Arm, Search};
use kinopt::glam::Vec3;
use kinopt::ik::Drag;
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::skinning::{PosedVertices, SkinningMethod};
use kinopt::task::Point;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Number of repetitions of each query; the fastest counts.
const ROUNDS: usize = 6;
const POSES: usize = 2000;
const FRAMES: usize = 300;

/// Upper half of Splitmix64, from 0 to 1, as in `web/tests/panda.js`.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 0.5_f64.powi(53)
    }

    fn configuration(&mut self, arm: &Arm) -> Vec<f64> {
        let limits = arm.limits();
        limits
            .map(|joint| joint.lower + self.unit() * (joint.upper - joint.lower))
            .collect()
    }
}

/// Fastest time of each query, microseconds, in order.
struct Fastest(Vec<f64>);

impl Fastest {
    fn of(queries: usize) -> Self {
        Self(vec![f64::INFINITY; queries])
    }

    fn record(&mut self, query: usize, started: Instant) {
        let micros = started.elapsed().as_secs_f64() * 1e6;
        self.0[query] = self.0[query].min(micros);
    }

    /// Prints `name`, the median, the mean and the 99th percentile, as `web/speed` reads them.
    fn print(mut self, name: &str) {
        self.0.sort_by(f64::total_cmp);
        let count = self.0.len();
        let mean = self.0.iter().sum::<f64>() / count as f64;
        let (median, high) = (self.0[count / 2], self.0[count * 99 / 100]);
        println!("{name}\t{median}\t{mean}\t{high}");
    }
}

fn poses(name: &str, search: Search) -> Outcome<()> {
    let robot = Robot::parse(&std::fs::read_to_string("models/franka_panda.urdf")?, "")?;
    let arm = Arm::builder(&robot, "base", "flange").with_search(search);
    let arm = arm.build()?;
    let mut random = Random(1);
    let goals = (0..POSES).map(|_| arm.base_from_tool(&random.configuration(&arm)));
    let goals = goals.collect::<Result<Vec<_>, _>>()?;
    let starts: Vec<_> = (0..POSES).map(|_| random.configuration(&arm)).collect();
    let mut fastest = Fastest::of(POSES);
    let mut reached = 0;
    for _ in 0..ROUNDS {
        for (query, (goal, start)) in goals.iter().zip(&starts).enumerate() {
            let started = Instant::now();
            let solution = arm.solve(goal, start)?;
            fastest.record(query, started);
            reached += usize::from(solution.reached);
        }
    }
    fastest.print(&format!("{name} ({reached} of {} reached)", ROUNDS * POSES));
    Ok(())
}

/// Moves the left hand along a closed curve, with the other tips pinned.
fn drag(rig: &Rig) -> Outcome<()> {
    let (skeleton, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let hand = skeleton.bone("left_hand")?;
    let tips = rig.constrained.iter().map(|&bone| skeleton.tip(bone));
    let tips: Vec<_> = tips.collect();
    let mut kinematics = ForwardKinematics::of_frames(skeleton.model(), &tips)?;
    let placements = kinematics.place(&rest)?.to_vec();
    let mut fastest = Fastest::of(FRAMES);
    for _ in 0..ROUNDS {
        let mut tasks = Problem::builder(skeleton.model());
        let mut dragged = None;
        for ((&pinned, &tip), placement) in rig.constrained.iter().zip(&tips).zip(&placements) {
            let task = tasks.add(Point::new(tip, placement.translation));
            if pinned == hand {
                dragged = Some((task, placement.translation));
            }
        }
        let (dragged, from) = dragged.ok_or("the humanoid's left hand is not pinned")?;
        let mut drag = Drag::new(tasks.build()?, &rest)?;
        for frame in 0..FRAMES {
            let phase = TAU * frame as f64 / FRAMES as f64;
            let drop = 1.0 - phase.cos();
            let target = [
                from.x + 0.1 * phase.sin(),
                from.y - 0.15 * drop,
                from.z - 0.1 * drop,
            ];
            drag.target_mut(dragged)?.set_target(target);
            let started = Instant::now();
            drag.advance();
            fastest.record(frame, started);
        }
    }
    fastest.print("a frame of the humanoid's drag");
    Ok(())
}

fn skin(rig: &Rig, name: &str, method: SkinningMethod) -> Outcome<()> {
    let rest = rig.skeleton.model().neutral();
    let mut rig = rig.clone();
    rig.mesh = rig.mesh.map(|mesh| mesh.with_computed_normals());
    let count = rig.mesh.as_ref().map_or(0, |mesh| mesh.positions().len());
    let mut posing = rig.posing(method)?;
    let (mut positions, mut normals) = (vec![Vec3::ZERO; count], vec![Vec3::ZERO; count]);
    let mut fastest = Fastest::of(FRAMES);
    for _ in 0..ROUNDS {
        for frame in 0..FRAMES {
            let started = Instant::now();
            posing.deform(
                &rest,
                PosedVertices {
                    positions: &mut positions,
                    normals: &mut normals,
                    tangents: &mut [],
                },
            )?;
            fastest.record(frame, started);
        }
    }
    fastest.print(name);
    Ok(())
}

fn main() -> Outcome<()> {
    poses("a Panda's pose, first", Search::First)?;
    poses("a Panda's pose, start", Search::Start)?;
    let rig = Rig::read("models/humanoid/humanoid.json")?;
    drag(&rig)?;
    skin(&rig, "its skin, linear", SkinningMethod::LinearBlend)?;
    skin(
        &rig,
        "its skin, dual quaternions",
        SkinningMethod::DualQuaternion,
    )
}
