//! Promise: markers of Plug-in Gait and of the CMU data base give joint centres, with gaps filled. Missing markers are
//! listed. Damaged C3D files are errors.

use kinopt::glam::DVec3;
use kinopt::io::c3d::{self, MarkerCapture};
use kinopt::motion::retarget::{BodyMap, Capture, UpAxis};
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;

/// Markers of a standing person, metres: x forward, y left, z up.
const MARKERS: [(&str, [f64; 3]); 29] = [
    ("LFHD", [0.08, 0.07, 1.65]),
    ("RFHD", [0.08, -0.07, 1.65]),
    ("LBHD", [-0.08, 0.07, 1.65]),
    ("RBHD", [-0.08, -0.07, 1.65]),
    ("C7", [-0.08, 0.0, 1.45]),
    ("T10", [-0.1, 0.0, 1.2]),
    ("CLAV", [0.06, 0.0, 1.4]),
    ("STRN", [0.1, 0.0, 1.25]),
    ("LSHO", [0.0, 0.19, 1.45]),
    ("LELB", [0.0, 0.3, 1.15]),
    ("LWRA", [0.05, 0.26, 0.9]),
    ("LWRB", [-0.01, 0.28, 0.9]),
    ("LFIN", [0.04, 0.28, 0.8]),
    ("RSHO", [0.0, -0.19, 1.45]),
    ("RELB", [0.0, -0.3, 1.15]),
    ("RWRA", [0.05, -0.26, 0.9]),
    ("RWRB", [-0.01, -0.28, 0.9]),
    ("RFIN", [0.04, -0.28, 0.8]),
    ("LASI", [0.1, 0.12, 1.0]),
    ("RASI", [0.1, -0.12, 1.0]),
    ("LPSI", [-0.1, 0.05, 1.02]),
    ("RPSI", [-0.1, -0.05, 1.02]),
    ("LKNE", [0.0, 0.15, 0.5]),
    ("LANK", [-0.02, 0.13, 0.09]),
    ("LTOE", [0.15, 0.1, 0.04]),
    ("RKNE", [0.0, -0.15, 0.5]),
    ("RANK", [-0.02, -0.13, 0.09]),
    ("RTOE", [0.15, -0.1, 0.04]),
    ("LHEE", [-0.08, 0.1, 0.03]),
];

fn person(rename: impl Fn(&str) -> String, frames: usize) -> MarkerCapture {
    let labels: Vec<String> = MARKERS.iter().map(|(name, _)| rename(name)).collect();
    let positions = (0..frames).flat_map(|frame| {
        // Walks forward.
        let moved = DVec3::new(0.01 * frame as f64, 0.0, 0.0);
        MARKERS
            .iter()
            .map(move |(_, at)| Some(DVec3::from(*at) + moved))
    });
    MarkerCapture::new(&labels, positions.collect(), 100.0).unwrap()
}

fn joint(capture: &Capture, frame: usize, name: &str) -> [f64; 3] {
    capture.frame(frame).unwrap()[capture.joint(name).unwrap()].to_array()
}

#[test]
fn joint_centres_are_those_of_the_marker_set() {
    let markers = person(|name| format!("Subject1:{name}"), 10);
    let capture = Capture::of_markers(&markers).unwrap();
    assert_eq!((capture.frames(), capture.frame_rate()), (10, 100.0));
    // Bell, Pedersen and Brand: 0.24 m between the front markers. The waist leans backward by 0.02 in 0.2.
    let [x, y, z] = joint(&capture, 0, "left_hip");
    assert!((y - 0.36 * 0.24).abs() < 1e-9, "{y}");
    // In the plane of the waist, which is 0.02 m higher at the back over 0.2 m.
    let lean = 0.02_f64.atan2(0.2);
    let depth = 0.24 * (0.19 * lean.cos() + 0.30 * lean.sin());
    let height = 0.24 * (0.19 * lean.sin() - 0.30 * lean.cos());
    assert!(
        (x - (0.1 - depth)).abs() < 1e-9 && (z - (1.0 + height)).abs() < 1e-9,
        "{x} {z}"
    );
    // Limbs are symmetric, and joints inside of their markers.
    for name in ["hip", "knee", "ankle", "foot", "shoulder", "elbow", "wrist"] {
        let [left, right] =
            ["left", "right"].map(|side| joint(&capture, 3, &format!("{side}_{name}")));
        assert!(
            (left[0] - right[0]).abs() < 1e-9 && (left[1] + right[1]).abs() < 1e-9,
            "{name}"
        );
        assert!(left[1] > 0.02, "{name}: {left:?}");
    }
    assert!(joint(&capture, 0, "left_knee")[1] < 0.15 && joint(&capture, 0, "left_elbow")[1] < 0.3);
    assert_eq!(capture.up_axis(), Some(UpAxis::Z));
    let guess = BodyMap::guess(&capture, floating_nao().model()).unwrap();
    assert_eq!(guess.skeleton, Some("smpl"));
    // The CMU data base has other names at the waist, and other letter case.
    let cmu = person(
        |name| match name {
            "LASI" => "lfwt".to_owned(),
            "RASI" => "rfwt".to_owned(),
            "LPSI" => "lbwt".to_owned(),
            "RPSI" => "rbwt".to_owned(),
            name => name.to_lowercase(),
        },
        10,
    );
    assert_eq!(Capture::of_markers(&cmu).unwrap(), capture);
}

#[test]
fn gaps_are_filled_linearly() {
    let mut markers = person(str::to_owned, 10);
    let expected = Capture::of_markers(&markers).unwrap();
    let (knee, count) = (markers.marker("LKNE").unwrap(), markers.names.len());
    for frame in 3..7 {
        markers.positions[frame * count + knee] = None;
    }
    let filled = Capture::of_markers(&markers).unwrap();
    for frame in 0..10 {
        let [a, b] = [&expected, &filled].map(|capture| joint(capture, frame, "left_knee"));
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12),
            "{frame}: {a:?} {b:?}"
        );
    }
    for frame in 0..10 {
        markers.positions[frame * count + knee] = None;
    }
    Capture::of_markers(&markers).says("missing: LKNE; the file has LFHD, RFHD");
    let unnamed = person(|name| format!("M{name}"), 2);
    Capture::of_markers(&unnamed).says("LASI or LFWT | the file has MLFHD");
}

/// The markers of [`person`] in millimetres at 50 frames per second, as ezc3d 1.7.2 writes them. `LKNE` is unseen in
/// frames 5 to 8.
const FILE: &[u8] = include_bytes!("person.c3d");

#[test]
fn file_of_another_program_is_read() {
    let read = c3d::from_bytes(FILE, "person.c3d").unwrap();
    let expected = person(str::to_owned, 12);
    assert_eq!(
        (&read.names, read.frames(), read.frame_rate),
        (&expected.names, 12, 50.0)
    );
    let (knee, count) = (read.marker("LKNE").unwrap(), read.names.len());
    let gaps: Vec<usize> = (0..12)
        .filter(|frame| read.positions[frame * count + knee].is_none())
        .collect();
    assert_eq!(gaps, [5, 6, 7, 8]);
    for (index, (found, expected)) in read.positions.iter().zip(&expected.positions).enumerate() {
        let distance = found.map_or(0.0, |found| found.distance(expected.unwrap()));
        assert!(distance < 1e-6, "{index}: {distance} m");
    }
}

#[test]
fn damaged_files_are_errors() {
    for length in (0..FILE.len() - 512).step_by(97) {
        // A file may end within its last block, which is padded.
        let cut = c3d::from_bytes(&FILE[..length], "cut.c3d");
        assert!(cut.is_err(), "{length} bytes");
    }
    for bytes in [&b""[..], b"C3D", &[0; 600], &[2, 0x50, 0, 0]] {
        c3d::from_bytes(bytes, "bad.c3d").says("bad.c3d: not a C3D file, or damaged");
    }
}
