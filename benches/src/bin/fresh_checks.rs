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
const PORTION_ENDS: [usize; 9] = [8, 64, 512, 1_000, 2_000, 4_000, 8_000, 16_000, 24_000];

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
    let count = PORTION_ENDS[PORTION_ENDS.len() - 1];
    let (arm, _) = panda_among(world)?;
    let n = arm.joint_count();
    let mut random = Sequence::new(0.5);
    let mut sampled = Vec::new();
    // From another arm, because the measured arm must not check them before.
    let (mut free, mut collision_free) = (Vec::new(), [false]);
    let mut in_contact = 0;
    while sampled.len() < count * n || free.len() < count * n {
        let q: Vec<f64> = arm
            .limits()
            .map(|joint| joint.lower + (joint.upper - joint.lower) * random.unit())
            .collect();
        arm.clear_by_spheres(&q, &mut collision_free)?;
        if sampled.len() < count * n {
            sampled.extend_from_slice(&q);
            in_contact += usize::from(!collision_free[0]);
        }
        if collision_free[0] && free.len() < count * n {
            free.extend_from_slice(&q);
        }
    }
    println!("{name}, {in_contact} of {count} touch; µs a configuration up to so many");
    println!(
        "{:>26} {}",
        "",
        PORTION_ENDS.map(|end| format!("{end:>7}")).join("")
    );
    for (sampling, q) in [("as drawn", &sampled), ("free", &free)] {
        for (batching, batch_size) in [("each alone", 1), ("eight at once", 8)] {
            let (arm, _) = panda_among(world)?;
            let mut row = String::new();
            let mut begin = 0;
            let mut collision_free = [false; 8];
            for end in PORTION_ENDS {
                let started = ThreadTime::now();
                for q in q[begin * n..end * n].chunks(batch_size * n) {
                    arm.clear_by_spheres(q, &mut collision_free[..batch_size])?;
                    black_box(&collision_free);
                }
                row += &format!("{:7.2}", started.micros() / (end - begin) as f64);
                begin = end;
            }
            println!("{:>12} {batching:>13} {row}", sampling);
        }
    }
    Ok(())
}
