//! Robot and queries of a comparison.

use std::path::{Path, PathBuf};

use kinopt::robot::Robot;
use kinopt::simd_ik::Chain;
use kinopt::spatial::{Placement, Quaternion, Vector3};
use kinopt_benches::{Sequence, random_poses};
use serde::Deserialize;

use crate::Failure;

/// One query.
pub struct Query {
    /// `base_from_target`.
    pub target: Placement<f64>,
    /// Target as x, y, z (metres), qw, qx, qy, qz.
    pub pose: [f64; 7],
    /// Start configuration, radians and metres.
    pub start: Vec<f64>,
}

/// A robot with its queries.
pub struct Workload {
    /// File of the robot.
    pub urdf: PathBuf,
    /// Base link: poses are relative to it.
    pub base: String,
    /// Tip link: it should reach the targets.
    pub tip: String,
    /// Joints between the two links.
    pub chain: Chain,
    /// Queries of the workload.
    pub queries: Vec<Query>,
}

/// Used content of a workload file.
#[derive(Deserialize)]
struct File {
    base_link: String,
    tip_link: String,
    targets: Vec<[f64; 7]>,
    starts: Vec<Vec<f64>>,
}

impl Workload {
    /// Random reachable poses of a robot, from random starts.
    ///
    /// # Errors
    /// Returns an error for a missing file or link, or if no chain connects the links.
    pub fn random(urdf: &Path, base: &str, tip: &str, count: usize) -> Result<Self, Failure> {
        let chain = read(urdf, base, tip)?;
        let poses = random_poses(&chain, count, &mut Sequence::new(0.25));
        let starts = poses.starts.chunks(chain.joints().len());
        let queries = poses
            .targets
            .iter()
            .zip(starts)
            .map(|(&target, start)| {
                let rotation = Quaternion::from_matrix(&target.rotation);
                let (p, v) = (target.translation, rotation.v);
                Query {
                    target,
                    pose: [p.x, p.y, p.z, rotation.w, v.x, v.y, v.z],
                    start: start.to_vec(),
                }
            })
            .collect();
        Ok(Self {
            urdf: urdf.into(),
            base: base.into(),
            tip: tip.into(),
            chain,
            queries,
        })
    }

    /// The first `count` queries of a workload file.
    ///
    /// # Errors
    /// Returns an error for a file that cannot be read, or that does not match the robot.
    pub fn from_file(urdf: &Path, targets: &Path, count: usize) -> Result<Self, Failure> {
        let file: File = serde_json::from_reader(std::fs::File::open(targets)?)?;
        let chain = read(urdf, &file.base_link, &file.tip_link)?;
        let joints = chain.joints().len();
        if file.starts.iter().any(|start| start.len() != joints) {
            return Err(format!("a start that has not {joints} joints").into());
        }
        let queries = file.targets.iter().zip(file.starts).take(count);
        let queries = queries
            .map(|(&pose, start)| Query {
                target: placement(pose),
                pose,
                start,
            })
            .collect();
        Ok(Self {
            urdf: urdf.into(),
            base: file.base_link,
            tip: file.tip_link,
            chain,
            queries,
        })
    }
}

fn read(urdf: &Path, base: &str, tip: &str) -> Result<Chain, Failure> {
    kinopt_benches::chain(&Robot::read(urdf)?, base, tip)
}

fn placement([x, y, z, qw, qx, qy, qz]: [f64; 7]) -> Placement<f64> {
    let length = (qw * qw + qx * qx + qy * qy + qz * qz).sqrt();
    let rotation = Quaternion {
        w: qw / length,
        v: Vector3::new(qx, qy, qz) * length.recip(),
    };
    Placement::new(rotation.to_matrix(), Vector3::new(x, y, z))
}
