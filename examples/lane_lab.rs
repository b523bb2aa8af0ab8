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
    let v: Vec<f64> = t.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    let q = Quaternion { w: v[3], v: Vector3::new(v[4], v[5], v[6]) };
    Placement::new(q.to_matrix(), Vector3::new(v[0], v[1], v[2]))
}
fn rows(t: &serde_json::Value) -> Vec<Vec<f64>> {
    t.as_array().unwrap().iter().map(|r| r.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()).collect()
}
pub struct Work { chain: Chain, targets: Vec<Placement<f64>>, starts: Vec<Vec<f64>>, truth: Vec<Vec<f64>> }
fn load(name: &str) -> Work {
    let dir = std::env::var("KINOPT_WORKLOADS").unwrap_or("/tmp/lane-lab".into());
    let d: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(format!("{dir}/{name}.json")).unwrap()).unwrap();
    let joints = d["chain"]["joints"].as_array().unwrap().iter().map(|j| {
        let a = rows(&serde_json::json!([j["axis"]]));
        ChainJoint { parent_from_joint: placement(&j["placement"]), axis: Vector3::new(a[0][0], a[0][1], a[0][2]), kind: JointKind::Revolute, lower: j["lower"].as_f64().unwrap(), upper: j["upper"].as_f64().unwrap() }
    }).collect();
    let chain = Chain::new(joints, placement(&d["chain"]["tip"])).unwrap();
    Work { chain, targets: d["targets"].as_array().unwrap().iter().map(pose).collect(), starts: rows(&d["starts"]), truth: rows(&d["truth"]) }
}
fn stats(name: &str, mut t: Vec<f64>) {
    let mean = t.iter().sum::<f64>() / t.len() as f64;
    t.sort_by(f64::total_cmp);
    println!("{name}: median {:.2} p99 {:.2} mean {:.2} max {:.1} us", t[t.len() / 2], t[t.len() * 99 / 100], mean, t[t.len() - 1]);
}
fn main() {
    let options = LaneOptions::default();
    for name in ["panda", "ur5"] {
        let w = load(name);
        let t0 = Instant::now();
        let solver = PoseSolver::new(&w.chain, options.clone());
        println!("build {:?}", t0.elapsed());
        let n = w.chain.joints().len();
        for (label, search) in [("first", Search::First), ("start", Search::Start)] {
            let mut q = vec![0.0; n];
            let mut best = vec![f64::INFINITY; w.targets.len()];
            let (mut ok, mut iters, mut atts) = (0, 0, 0);
            for round in 0..5 {
                for (i, (t, s)) in w.targets.iter().zip(&w.starts).enumerate() {
                    let t0 = Instant::now();
                    let out = solver.solve(t, s, search, &mut q);
                    best[i] = best[i].min(t0.elapsed().as_nanos() as f64 / 1e3);
                    if round == 0 {
                        ok += usize::from(out.reached);
                        iters += out.iterations;
                        atts += out.attempts;
                        let fk = w.chain.base_from_tip(&q);
                        assert!((fk.translation - t.translation).norm() < 1e-6 || !out.reached);
                        assert!(w.chain.joints().iter().zip(&q).all(|(j, q)| j.lower <= *q && *q <= j.upper));
                    }
                }
            }
            println!("{name} {label}: solved {ok}/{} iterations/solve {:.2} attempts/solve {:.2}", w.targets.len(), iters as f64 / w.targets.len() as f64, atts as f64 / w.targets.len() as f64);
            stats("   single", best);
        }
        let fk = w.chain.base_from_tip(&w.truth[0]);
        println!("check fk {:e}", (fk.translation - w.targets[0].translation).norm());
    }
}
