//! Times the lane engine on workload files; KINOPT_WORKLOADS names their folder.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]
use kinopt::lanes::*;
use kinopt::spatial::*;
use std::time::Instant;

fn placement(rows: &serde_json::Value) -> Placement<f64> {
    let v = |i: usize, j: usize| rows[i][j].as_f64().unwrap();
    let col = |j| Vector3::new(v(0, j), v(1, j), v(2, j));
    Placement::new(Matrix3::from_columns(col(0), col(1), col(2)), col(3))
}
fn pose(t: &serde_json::Value) -> Placement<f64> {
    let v: Vec<f64> = t
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect();
    let q = Quaternion {
        w: v[3],
        v: Vector3::new(v[4], v[5], v[6]),
    };
    Placement::new(q.to_matrix(), Vector3::new(v[0], v[1], v[2]))
}
fn rows(t: &serde_json::Value) -> Vec<Vec<f64>> {
    t.as_array()
        .unwrap()
        .iter()
        .map(|r| {
            r.as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect()
        })
        .collect()
}
pub struct Work {
    chain: Chain,
    targets: Vec<Placement<f64>>,
    starts: Vec<Vec<f64>>,
    truth: Vec<Vec<f64>>,
}
fn load(name: &str) -> Work {
    let dir = std::env::var("KINOPT_WORKLOADS").unwrap_or("/tmp/lane-lab".into());
    let d: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(format!("{dir}/{name}.json")).unwrap())
            .unwrap();
    let joints = d["chain"]["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|j| {
            let a = rows(&serde_json::json!([j["axis"]]));
            ChainJoint {
                parent_from_joint: placement(&j["placement"]),
                axis: Vector3::new(a[0][0], a[0][1], a[0][2]),
                kind: JointKind::Revolute,
                lower: j["lower"].as_f64().unwrap(),
                upper: j["upper"].as_f64().unwrap(),
            }
        })
        .collect();
    let chain = Chain::new(joints, placement(&d["chain"]["tip"])).unwrap();
    Work {
        chain,
        targets: d["targets"].as_array().unwrap().iter().map(pose).collect(),
        starts: rows(&d["starts"]),
        truth: rows(&d["truth"]),
    }
}
fn stats(name: &str, mut t: Vec<f64>) {
    let mean = t.iter().sum::<f64>() / t.len() as f64;
    t.sort_by(f64::total_cmp);
    println!(
        "{name}: median {:.2} p99 {:.2} mean {:.2} max {:.1} us",
        t[t.len() / 2],
        t[t.len() * 99 / 100],
        mean,
        t[t.len() - 1]
    );
}
fn main() {
    let env = |n: &str, d: f64| {
        std::env::var(n)
            .ok()
            .and_then(|v| v.parse().ok())
            .unwrap_or(d)
    };
    let mut options = LaneOptions::default();
    options.damping = env("DAMP", options.damping);
    options.metres_per_radian = env("MPR", options.metres_per_radian);
    options.stall_limit = env("STALL", f64::from(options.stall_limit)) as u32;
    let only = std::env::var("ONLY").unwrap_or_default();
    for name in ["panda", "ur5"] {
        if !only.is_empty() && !only.contains(name) {
            continue;
        }
        let w = load(name);
        let t0 = Instant::now();
        let solver = PoseSolver::new(&w.chain, options.clone()).unwrap();
        println!(
            "build {:?}, atlas {} kB",
            t0.elapsed(),
            solver.atlas_memory() / 1024
        );
        let n = w.chain.joints().len();
        for (label, search) in [("first", Search::First), ("start", Search::Start)] {
            if !only.is_empty() && !only.contains(label) {
                continue;
            }
            let mut q = vec![0.0; n];
            let mut best = vec![f64::INFINITY; w.targets.len()];
            let (mut ok, mut iters, mut atts) = (0, 0, 0);
            for round in 0..env("ROUNDS", 5.0) as u32 {
                for (i, (t, s)) in w.targets.iter().zip(&w.starts).enumerate() {
                    let t0 = Instant::now();
                    let out = solver.solve(t, s, search, None, &mut q).unwrap();
                    best[i] = best[i].min(t0.elapsed().as_nanos() as f64 / 1e3);
                    if round == 0 {
                        ok += usize::from(out.reached);
                        iters += out.iterations;
                        atts += out.attempts;
                        let fk = w.chain.base_from_tip(&q);
                        assert!((fk.translation - t.translation).norm() < 1e-6 || !out.reached);
                        assert!(
                            w.chain
                                .joints()
                                .iter()
                                .zip(&q)
                                .all(|(j, q)| j.lower <= *q && *q <= j.upper)
                        );
                    }
                }
            }
            println!(
                "{name} {label}: solved {ok}/{} iterations/solve {:.2} attempts/solve {:.2}",
                w.targets.len(),
                iters as f64 / w.targets.len() as f64,
                atts as f64 / w.targets.len() as f64
            );
            stats("   single", best);
            let starts = w.starts.concat();
            let mut qs = vec![0.0; starts.len()];
            let blank = Outcome::default();
            let mut outs = vec![blank; w.targets.len()];
            let mut best = f64::INFINITY;
            for _ in 0..env("BROUNDS", 7.0) as u32 {
                let t0 = Instant::now();
                solver
                    .solve_batch(&w.targets, &starts, search, &mut qs, &mut outs)
                    .unwrap();
                best = best.min(t0.elapsed().as_nanos() as f64 / 1e3 / w.targets.len() as f64);
            }
            println!(
                "   batch {:.3} us/pose, solved {}, iterations {:.2} attempts {:.3}",
                best,
                outs.iter().filter(|o| o.reached).count(),
                outs.iter().map(|o| o.iterations).sum::<u32>() as f64 / outs.len() as f64,
                outs.iter().map(|o| o.attempts).sum::<u32>() as f64 / outs.len() as f64
            );
            for (i, o) in outs.iter().enumerate().filter(|(_, o)| !o.reached) {
                println!("   unsolved {i} {o:?} truth {:?}", w.truth[i]);
            }
        }
        let fk = w.chain.base_from_tip(&w.truth[0]);
        println!(
            "check fk {:e}",
            (fk.translation - w.targets[0].translation).norm()
        );
    }
    let w = load("panda_track");
    let solver = PoseSolver::new(&w.chain, options).unwrap();
    let n = w.chain.joints().len();
    let mut qs = vec![0.0; n * w.targets.len()];
    let blank = Outcome::default();
    let mut outs = vec![blank; w.targets.len()];
    let mut best = f64::INFINITY;
    for _ in 0..env("TROUNDS", 15.0) as u32 {
        let t0 = Instant::now();
        solver
            .track(&w.targets, &w.starts[0], &mut qs, &mut outs)
            .unwrap();
        best = best.min(t0.elapsed().as_nanos() as f64 / 1e3 / w.targets.len() as f64);
    }
    let mut flips = 0;
    let mut worst: f64 = 0.0;
    for i in 1..w.targets.len() {
        for j in 0..n {
            let moved = (qs[i * n + j] - qs[(i - 1) * n + j]).abs()
                - (w.truth[i][j] - w.truth[i - 1][j]).abs();
            worst = worst.max(moved);
            flips += usize::from(moved > 0.2);
        }
    }
    println!(
        "track {best:.3} us/step solved {} flips {flips} worst excess {worst:.4} iterations {:.2}",
        outs.iter().filter(|o| o.reached).count(),
        outs.iter().map(|o| o.iterations).sum::<u32>() as f64 / outs.len() as f64
    );
}
