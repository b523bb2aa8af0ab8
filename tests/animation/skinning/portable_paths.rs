//! Promise: `KINOPT_PORTABLE` selects the portable code paths of a process, unless it is empty or 0.
#![allow(clippy::print_stdout)]

use std::process::Command;

use glam::Affine3A;
use kinopt::skinning::{PackedLinearBlend, PackedWeights};
use support::random::Random;
use support::skins::{Vertices, rigid, weights};

/// Environment variable that marks the child process.
const CHILD_VARIABLE: &str = "KINOPT_TESTS_ASK_FOR_THE_PATH";

/// True if this process uses the portable path: the other one rounds a product and a sum once.
fn is_portable() -> bool {
    let mut random = Random::new(9);
    let (count, bones) = (500, 5);
    let weights = weights(&mut random, count, bones, 4);
    let packed = PackedWeights::new(&weights).unwrap();
    let rest = Vertices::random(&mut random, count);
    let transforms: Vec<Affine3A> = (0..bones).map(|_| rigid(&mut random)).collect();
    let blend = PackedLinearBlend::new(&packed, &transforms).unwrap();
    rest.deformed(&blend).positions == rest.deformed(&blend.portable()).positions
}

#[test]
fn portable_paths_are_opt_in() {
    if std::env::var_os(CHILD_VARIABLE).is_some() {
        println!("portable: {}", is_portable());
        return;
    }
    let takes_them = |value: Option<&str>| {
        let mut command = Command::new(std::env::current_exe().unwrap());
        let test = "skinning::portable_paths::portable_paths_are_opt_in";
        command.args(["--exact", test, "--nocapture"]);
        command
            .env(CHILD_VARIABLE, "1")
            .env_remove("KINOPT_PORTABLE");
        command.envs(value.map(|value| ("KINOPT_PORTABLE", value)));
        let output = command.output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        let [yes, no] = [true, false].map(|is| text.contains(&format!("portable: {is}")));
        assert!(output.status.success() && yes != no, "{text}");
        yes
    };
    let by_itself = takes_them(None);
    for value in ["", "0"] {
        assert_eq!(takes_them(Some(value)), by_itself, "{value}");
    }
    for value in ["1", "yes"] {
        assert!(takes_them(Some(value)), "{value}");
    }
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        assert!(!by_itself);
    }
}
