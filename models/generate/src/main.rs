//! Writes the rigs under `models/`, and pictures of `docs/`. Two runs write the same bytes.
//!
//!     cargo run --release -p kinopt-models              # the rigs
//!     cargo run --release -p kinopt-models -- picture   # docs/humanoid.png
//!     cargo run --release -p kinopt-models -- dragged   # docs/dragged.png
//!     cargo run --release -p kinopt-models -- crouching # docs/crouching.png
//!     cargo run --release -p kinopt-models -- film      # docs/kinopt.gif
//!     cargo run --release -p kinopt-models -- look DIR  # the rigs from several sides, as PNG

mod contact_sheet;
mod crouching;
mod dragged;
mod figure;
mod film;
mod humanoid;
mod humanoid_body;
mod humanoid_wave;
mod landmarks;
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

/// Error of the generator.
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
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        [] => {
            robot_arm::rig()?.write(rig_path("robot-arm"))?;
            humanoid::rig()?.write(rig_path("humanoid"))?;
        }
        ["picture"] => {
            let rig = Rig::read(rig_path("humanoid"))?;
            picture::picture(&rig, &root().join("docs/humanoid.png"))?;
        }
        ["dragged"] => {
            let rig = Rig::read(rig_path("humanoid"))?;
            dragged::dragged(&rig, &root().join("docs/dragged.png"))?;
        }
        ["crouching"] => {
            let rig = Rig::read(rig_path("humanoid"))?;
            let cones = root().join("models/humanoid/cones.json");
            crouching::crouching(&rig, &cones, &root().join("docs/crouching.png"))?;
        }
        ["film"] => film::film(&root(), &root().join("docs/kinopt.gif"))?,
        ["look", folder] => {
            for name in ["robot-arm", "humanoid"] {
                let rig = Rig::read(rig_path(name))?;
                let eyes = [("front", 1.0, -0.5), ("back", -0.8, 0.7)];
                for (side, x, y) in eyes {
                    let path = Path::new(folder).join(format!("{name}-{side}.png"));
                    contact_sheet::contact_sheet(&rig, DVec3::new(x, y, 0.35), &path)?;
                }
            }
        }
        _ => {
            return Err(
                "usage: kinopt-models [picture | dragged | crouching | film | look DIR]".into(),
            );
        }
    }
    Ok(())
}

/// Root folder of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn rig_path(name: &str) -> PathBuf {
    root().join(format!("models/{name}/{name}.json"))
}
