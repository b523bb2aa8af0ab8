//! Processor time of checks of new configurations among a large number of obstacles.
//!
//! `fresh_checks [WORDS…]`: the worlds whose names contain all words. Times are by portions, which show the cost of the
//! first checks and the effect of earlier ones.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::hint::black_box;

use kinopt::collision::World;
use kinopt_benches::{Sequence, ThreadTime, cloud_of_points, panda_among, shell_of_primitives};

/// Ends of the portions, in configurations.
const ENDS: [usize; 9] = [8, 64, 512, 1_000, 2_000, 4_000, 8_000, 16_000, 24_000];

type Build = fn() -> Result<World, Box<dyn Error>>;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let worlds: [(&str, Build); 5] = [
        ("30 primitives", || shell_of_primitives(30)),
        ("1000 primitives", || shell_of_primitives(1_000)),
        ("10000 primitives", || shell_of_primitives(10_000)),
        ("10000 points", || cloud_of_points(10_000)),
        ("1000000 points", || cloud_of_points(1_000_000)),
    ];
    for (name, build) in worlds {
        if words.iter().all(|word| name.contains(word.as_str())) {
            measure(name, &build()?)?;
        }
    }
    Ok(())
}

fn measure(name: &str, world: &World) -> Result<(), Box<dyn Error>> {
    let count = ENDS[ENDS.len() - 1];
    let (arm, _) = panda_among(world)?;
    let n = arm.joint_count();
    let mut random = Sequence::new(0.5);
    let mut all = Vec::new();
    // From another arm, because the measured arm must not check them before.
    let (mut free, mut clear) = (Vec::new(), [false]);
    let mut touching = 0;
    while all.len() < count * n || free.len() < count * n {
        let q: Vec<f64> = arm
            .limits()
            .map(|joint| joint.lower + (joint.upper - joint.lower) * random.unit())
            .collect();
        arm.clear_by_spheres(&q, &mut clear)?;
        if all.len() < count * n {
            all.extend_from_slice(&q);
            touching += usize::from(!clear[0]);
        }
        if clear[0] && free.len() < count * n {
            free.extend_from_slice(&q);
        }
    }
    println!("{name}, {touching} of {count} touch; µs a configuration up to so many");
    println!(
        "{:>26} {}",
        "",
        ENDS.map(|end| format!("{end:>7}")).join("")
    );
    for (what, q) in [("as drawn", &all), ("free", &free)] {
        for (how, at_once) in [("each alone", 1), ("eight at once", 8)] {
            let (arm, _) = panda_among(world)?;
            let mut row = String::new();
            let mut begin = 0;
            let mut clear = [false; 8];
            for end in ENDS {
                let begun = ThreadTime::now();
                for q in q[begin * n..end * n].chunks(at_once * n) {
                    arm.clear_by_spheres(q, &mut clear[..at_once])?;
                    black_box(&clear);
                }
                row += &format!("{:7.2}", begun.micros() / (end - begin) as f64);
                begin = end;
            }
            println!("{:>12} {how:>13} {row}", what);
        }
    }
    Ok(())
}
