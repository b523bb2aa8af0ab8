//! Makes the rigs under `models/`, the same bytes every time, and the picture of the README.
//!
//!     cargo run --release -p kinopt-models              # rigs
//!     cargo run --release -p kinopt-models -- picture   # docs/humanoid.png

mod contact_sheet;
mod figure;
mod humanoid;
mod humanoid_body;
mod picture;
mod polygonise;
mod remesh;
mod render;
mod robot_arm;
mod skin;
mod surface;
mod weights;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::DVec3;
use kinopt::io::rig::Rig;

/// Whatever went wrong, in words.
pub(crate) type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            #[allow(clippy::print_stderr)] // This is a program, not a library.
            {
                eprintln!("{failure}");
            }
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let root: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => {
            write(&robot_arm::rig()?, &root, "robot-arm")?;
            write(&humanoid::rig()?, &root, "humanoid")?;
        }
        ["robot"] => {
            let rig = Rig::read(root.join("models/robot-arm/robot-arm.json"))?;
            let at = |key: usize| {
                let mut q = vec![0.0; rig.skeleton.angles()];
                for track in rig.clip.tracks() {
                    for k in 0..3 {
                        q[3 * track.bone.index() + k] = track.keys[key].angles[k];
                    }
                }
                q
            };
            let poses = [at(0), at(2), at(4), at(6)];
            for (index, eye) in [DVec3::new(1.0, -0.9, 0.4), DVec3::new(-0.5, 1.0, 0.4)]
                .into_iter()
                .enumerate()
            {
                contact_sheet::contact_sheet(
                    &rig,
                    &poses,
                    eye,
                    [1800, 560],
                    &root.join(format!("target/robot{index}.png")),
                )?;
            }
        }
        ["picture"] => {
            let rig = Rig::read(root.join("models/humanoid/humanoid.json"))?;
            picture::picture(&rig, &root.join("docs/humanoid.png"))?;
        }
        ["sheet"] => {
            let rig = Rig::read(root.join("models/humanoid/humanoid.json"))?;
            let n = rig.skeleton.angles();
            let set = |list: &[(&str, [f64; 3])]| -> Result<Vec<f64>, Failure> {
                let mut q = vec![0.0; n];
                for (name, angles) in list {
                    let bone = rig.skeleton.bone(name)?.index();
                    for k in 0..3 {
                        q[3 * bone + k] = angles[k].to_radians();
                    }
                }
                Ok(q)
            };
            let poses = [
                set(&[])?,
                set(&[
                    ("left_forearm", [0., 120., 0.]),
                    ("right_forearm", [0., 60., 0.]),
                    ("left_upper_arm", [0., 60., -60.]),
                    ("right_upper_arm", [0., 90., 90.]),
                    ("left_thigh", [0., 90., 0.]),
                    ("left_shin", [0., 100., 0.]),
                    ("right_thigh", [0., -20., 0.]),
                    ("head", [25., 15., 0.]),
                ])?,
                set(&[
                    ("spine", [10., 30., 0.]),
                    ("chest", [10., 20., 0.]),
                    ("upper_chest", [10., 30., 0.]),
                    ("left_upper_arm", [60., 120., -60.]),
                    ("right_upper_arm", [0., -45., 80.]),
                    ("left_hand", [0., 60., 70.]),
                    ("right_forearm", [0., 140., 0.]),
                    ("right_thigh", [0., 110., 10.]),
                    ("right_shin", [0., 130., 0.]),
                    ("left_foot", [0., -45., 0.]),
                    ("left_toes", [0., 60., 0.]),
                    ("neck", [0., 30., 0.]),
                ])?,
            ];
            for (index, eye) in [DVec3::new(1.0, -0.4, 0.25), DVec3::new(-0.7, -0.8, 0.3)]
                .into_iter()
                .enumerate()
            {
                contact_sheet::contact_sheet(
                    &rig,
                    &poses,
                    eye,
                    [1400, 640],
                    &root.join(format!("target/sheet{index}.png")),
                )?;
            }
        }
        _ => return Err("usage: kinopt-models [picture]".into()),
    }
    Ok(())
}

fn write(rig: &Rig, root: &Path, name: &str) -> Result<(), Failure> {
    let path = root.join(format!("models/{name}/{name}.json"));
    rig.write(&path)?;
    let vertices = rig.mesh.as_ref().map_or(0, |mesh| mesh.positions().len());
    #[allow(clippy::print_stdout)] // This is a program, not a library.
    {
        println!(
            "{name}: {} bones, {vertices} vertices",
            rig.skeleton.bones().len()
        );
    }
    Ok(())
}
