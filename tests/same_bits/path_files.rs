//! Promise: so it is for paths before they are solved, and for times afterwards: tables that are read, curves, options that cannot be,
//! trapezoids of speed.
#![allow(clippy::unwrap_used)]

use kinopt::motion::path::{CartesianPath, CsvColumns, PathSolver, QuaternionOrder, Traversal};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::paths::{bare_arm, placement};
use crate::robot_texts::{add_error, add_text};

const HEADERS: [&str; 14] = [
    "x,y,z",
    "time,x,y,z",
    "pos_x;pos_y;pos_z;t",
    "Position X\tPosition Y\tPosition Z",
    "px py pz s",
    "time,target-POS_X,target-POS_Y,target-POS_Z,target-ROT_X,target-ROT_Y,target-ROT_Z,target-ROT_W",
    "\"x\",\"y\",\"z\",\"w\",\"qx\",\"qy\",\"qz\"",
    "x,y,z,tool",
    "x,y,z,tool_index,timestamp",
    "x,y,z,qx,qy,qz",
    "a/x,b:y,c-z,ow,ox,oy,oz,seconds",
    "x,y,z,rw,rx,ry,rz,tool number",
    "one,two,three",
    "x,y,q",
];

const TABLES: [&str; 34] = [
    "",
    "\u{feff}# only\n\n",
    "x,y,z\n",
    "1,2,3",
    "1 2 3\n\n 4   5 6 \n",
    "1;2;3\n4;5;6",
    "0,1,2,3\n0.5,4,5,6",
    "1,1,2,3\n2,4,5,6",
    "0,1,2,3\n0,4,5,6",
    "1,2,3,0.6,0.8,0,0\n1,2,3,0.6,0,0.8,0",
    "0,1,2,3,1,0,0,0\n0.25,1,2,3,0,0,0.6,0.8",
    "5,1,2,3,1,0,0,0\n6,1,2,3,0,0,0.6,0.8",
    "1,2",
    "1,2,3,4,5",
    "1,2,3,4,5,6",
    "1,2,3,4,5,6,7,8,9",
    "1,2,3\n1,2",
    "1,2,3\n1,2,x",
    "1,2,3\n1,2,inf",
    "1,2,,4\n",
    "1,2,3,0.6,0.8,0.0005,0",
    "1,2,3,0.6,0.8,0.1,0",
    "1,2,3,0,0,0,0",
    "x,y,z,tool\n1,2,3,1",
    "x,y,z,tool\n1,2,3,255",
    "x,y,z,tool\n1,2,3,256",
    "x,y,z,tool\n1,2,3,0.5",
    "x,y,z,tool\n1,2,3,-1",
    "time,x,y,z\n0,1,2,3\n1,4,5,6",
    "time,x,y,z\n1,1,2,3\n0,4,5,6",
    "time,x,y,z\n1,1,2,3\n1,4,5,6",
    "a,1,2\n4,5,6",
    "1e300,2,3",
    "time,x,y,z,tool,qw,qx,qy,qz\n1,2,3,4,5,0,1,0,0",
];

fn add_read(digest: &mut Digest, text: &str) {
    for order in [QuaternionOrder::WFirst, QuaternionOrder::WLast] {
        match CartesianPath::from_csv(text.as_bytes(), "path.csv", order) {
            Ok((path, columns)) => {
                let columns: CsvColumns = columns;
                add_text(digest, &format!("{path:?} {columns:?} {columns}"));
            }
            Err(error) => add_error(digest, &error),
        }
    }
}

fn tables() -> Value {
    let mut digest = Digest::new();
    TABLES.iter().for_each(|text| add_read(&mut digest, text));
    for header in HEADERS {
        let sign = header.chars().find(|c| ",;\t ".contains(*c)).unwrap();
        let own = |c: char| c == ',' || c == ';' || c == '\t' || sign == ' ' && c == ' ';
        let count = header.split(own).count();
        let row = |first: f64| {
            let numbers = [first, 0.5, 2.0, 0.0, 0.6, 0.8, 0.0, 3.0];
            let numbers = numbers.map(|number| number.to_string());
            numbers[..count.min(8)].join(&sign.to_string())
        };
        for unit in [[0.0, 0.25], [0.25, 0.0]] {
            add_read(
                &mut digest,
                &format!("{header}\n{}\n{}\n", row(unit[0]), row(unit[1])),
            );
        }
        // Quaternions at other places.
        let turned = header.replace("qx", "no").replace("ROT_W", "no");
        add_read(&mut digest, &format!("{turned}\n{}\n", row(1.0)));
    }
    add_error(
        &mut digest,
        &CartesianPath::from_csv(b"1,2\xff", "p", QuaternionOrder::default()).unwrap_err(),
    );
    digest.value()
}

fn curves() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(31));
    let base_from_path = placement(&mut random, 0.5);
    for count in [1, 2, 3, 6] {
        let keys: Vec<_> = (0..count).map(|_| placement(&mut random, 1.0)).collect();
        let mut time = 0.5;
        let times: Vec<f64> = (0..count)
            .map(|_| {
                time += random.within(0.1, 2.0);
                time
            })
            .collect();
        for key_times in [None, Some(&times[..])] {
            for steps in [0, 1, 5] {
                match CartesianPath::spline(keys.clone(), key_times, steps) {
                    Ok(path) => add_text(
                        &mut digest,
                        &format!("{path:?} {:?}", path.clone().moved(&base_from_path)),
                    ),
                    Err(error) => add_error(&mut digest, &error),
                }
            }
        }
        let path = CartesianPath::new(keys).unwrap();
        let bad = [
            path.clone().with_times(vec![1.0; count]),
            path.clone().with_times(vec![f64::INFINITY]),
            path.clone().with_times(vec![]),
            path.clone().with_tools(vec![0; count]),
            path.clone().with_tools(vec![0, 1]),
            path.with_times(times),
        ];
        for path in bad {
            match path {
                Ok(path) => add_text(
                    &mut digest,
                    &format!(
                        "{path:?} {:?} {:?} {:?}",
                        path.times(),
                        path.tools(),
                        path.traversal()
                    ),
                ),
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    let far = [1.7e308, -1.7e308].map(|x| Placement::translation(Vector3::new(x, 0.0, 0.0)));
    add_error(
        &mut digest,
        &CartesianPath::spline(far.to_vec(), None, 2).unwrap_err(),
    );
    add_error(&mut digest, &CartesianPath::new(vec![]).unwrap_err());
    let mut skewed = placement(&mut random, 1.0);
    skewed.rotation.x = skewed.rotation.x * (1.0 + 2e-6);
    add_error(
        &mut digest,
        &CartesianPath::new(vec![far[0], skewed]).unwrap_err(),
    );
    digest.value()
}

fn times() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(32));
    let inf = f64::INFINITY;
    for count in [0, 1, 2, 3, 9] {
        let mut rows: Vec<Vec<f64>> = (0..count)
            .map(|_| (0..3).map(|_| random.within(-1.0, 1.0)).collect())
            .collect();
        if count == 9 {
            // The arm waits.
            rows[4] = rows[3].clone();
            rows[8] = rows[7].clone();
        }
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        for rests in [&[][..], &[1], &[2, 3, 7], &[5], &[4, 20], &[8]] {
            for (speeds, accelerations) in [
                ([1.0, 2.0, 0.5], [3.0, 0.5, 7.0]),
                ([0.1, 0.1, 0.1], [30.0; 3]),
                ([inf, inf, 3.0], [0.2, 9.0, 1.0]),
            ] {
                let found = crate::drawn_paths::row_times(&rows, rests, &speeds, &accelerations);
                digest.doubles(found.unwrap());
            }
        }
        for (speeds, accelerations) in [
            (&[1.0; 2][..], &[1.0; 3][..]),
            (&[1.0; 3], &[1.0; 4]),
            (&[1.0, 0.0, 1.0], &[1.0; 3]),
            (&[1.0; 3], &[1.0, inf, 1.0]),
            (&[f64::NAN; 3], &[1.0; 3]),
            (&[1.0; 3], &[-1.0; 3]),
        ] {
            match crate::drawn_paths::row_times(&rows, &[], speeds, accelerations) {
                Ok(times) => digest.doubles(times),
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    digest.value()
}

/// Errors of options, each by its text.
fn refusals() -> Value {
    let mut digest = Digest::new();
    let robot = robot("universal_ur5e");
    let arm = bare_arm(&robot, "base", "flange");
    let other = bare_arm(&robot, "base", "link5");
    let q = [0.3, -1.2, 1.4, -1.6, -1.5, 0.2];
    let begin = arm.base_from_tool(&q).unwrap();
    let end = begin
        * Placement::new(
            rotation_exp(Vector3::new(0.0, 0.0, 0.1)),
            Vector3::new(0.0, 0.0, 0.01),
        );
    let path = CartesianPath::new(vec![begin, end]).unwrap();
    let solver = || PathSolver::new(&arm).with_samples(8);
    let far = [8.0, -1.2, 1.4, -1.6, -1.5, 0.2];
    let timed = path.clone().with_times(vec![0.0, 1.0]).unwrap();
    let asked = [
        (solver().with_max_step(0.0), &path),
        (solver().with_max_step(f64::NAN), &path),
        (solver().with_samples(0), &path),
        (solver().with_samples(3), &path),
        (solver().with_samples(4), &path),
        (solver().with_samples(4097), &path),
        (solver().with_joint_weights(&[1.0; 5]), &path),
        (
            solver().with_joint_weights(&[1.0, 0.0, 1.0, 1.0, 1.0, 1.0]),
            &path,
        ),
        (solver().with_start(&[0.0; 7]), &path),
        (solver().with_start(&[f64::NAN; 6]), &path),
        (solver().with_start(&[0.0; 6]), &path),
        (solver().with_end(&q), &path),
        (solver().with_start(&q), &path),
        (solver().with_start(&far), &path),
        (solver().with_end(&[0.0; 5]), &path),
        (solver().with_times_kept(true), &path),
        (solver().with_times_kept(true), &timed),
        (solver().with_tools([&other]), &path),
    ];
    let tools = path.clone().with_tools(vec![0, 2]).unwrap();
    let both = [Traversal::Cyclic, Traversal::AnyStart];
    let turned = both.map(|way| {
        [
            path.clone().with_traversal(way),
            timed.clone().with_traversal(way),
        ]
    });
    let turned = turned.as_flattened();
    let more = turned.iter().flat_map(|path| {
        [
            (solver().with_end(&q), path),
            (solver().with_times_kept(true), path),
            (solver().with_start(&q), path),
        ]
    });
    for (solver, path) in asked.into_iter().chain(more).chain([(solver(), &tools)]) {
        match solver.solve(path) {
            Ok(found) => add_text(&mut digest, &format!("{found:?}")),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

#[test]
fn of_paths_before_and_after() {
    check(&[
        ("paths: tables of points", tables()),
        ("paths: curves", curves()),
        ("paths: times of rows", times()),
        ("paths: what is refused", refusals()),
    ]);
}
