//! Joint centres from the markers of a capture.
//!
//! The marker set is that of Vicon's Plug-in Gait full body model, which the CMU data base uses with other names at the
//! waist (`LFWT`, `RFWT`, `LBWT`, `RBWT`). Hip centres are those of Bell, Pedersen and Brand (1990), "A comparison of the
//! accuracy of several hip center location prediction methods": 0.36 of the distance between the front waist markers to
//! the side, 0.19 backward and 0.30 downward from their middle. Other centres are inward of their markers by fractions of
//! that distance, estimates of this project. They are accurate to a few centimetres, without anthropometric data of the
//! subject.

use glam::DVec3;

use super::{Capture, RetargetError};
use kinopt_animation::io::c3d::MarkerCapture;

/// Names of a marker, in order of preference.
type MarkerNames = &'static [&'static str];

/// Waist markers: left front, right front, left back, right back.
const WAIST: [MarkerNames; 4] = [
    &["LASI", "LFWT"],
    &["RASI", "RFWT"],
    &["LPSI", "LBWT"],
    &["RPSI", "RBWT"],
];
/// Markers of one side, without the letter of the side.
const KNEE: MarkerNames = &["KNE"];
const ANKLE: MarkerNames = &["ANK"];
const TOE: MarkerNames = &["TOE"];
const SHOULDER: MarkerNames = &["SHO"];
const ELBOW: MarkerNames = &["ELB"];
const WRIST: [MarkerNames; 2] = [&["WRA"], &["WRB"]];
const HEAD: [MarkerNames; 4] = [&["LFHD"], &["RFHD"], &["LBHD"], &["RBHD"]];
/// Upper trunk: seventh cervical vertebra and clavicle.
const NECK: [MarkerNames; 2] = [&["C7"], &["CLAV"]];
/// Lower end of the sternum and tenth thoracic vertebra.
const CHEST: [MarkerNames; 2] = [&["STRN"], &["T10"]];

/// Hip centre from the middle of the front waist markers, relative to their distance: to the side, backward, downward.
const HIP: [f64; 3] = [0.36, 0.19, 0.30];
/// Distances of joint centres from their markers, relative to the distance of the front waist markers.
const KNEE_INWARD: f64 = 0.21;
const ANKLE_INWARD: f64 = 0.15;
const SHOULDER_DOWN: f64 = 0.18;
const ELBOW_INWARD: f64 = 0.15;

/// Joints with the names of SMPL, whose map is known.
const JOINTS: [&str; 18] = [
    "pelvis",
    "spine3",
    "neck",
    "head",
    "left_hip",
    "right_hip",
    "left_knee",
    "right_knee",
    "left_ankle",
    "right_ankle",
    "left_foot",
    "right_foot",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
];

impl Capture {
    /// Creates a capture of joint centres from the markers of Plug-in Gait, or of the CMU data base. The joints have the
    /// names of SMPL. Gaps of markers are filled.
    ///
    /// # Errors
    /// Returns an error that lists the missing markers and those of the file.
    pub fn of_markers(markers: &MarkerCapture) -> Result<Self, RetargetError> {
        let tracks = MarkerTracks::of(markers)?;
        let mut numbers = Vec::with_capacity(3 * JOINTS.len() * markers.frames());
        for frame in 0..markers.frames() {
            let joints = tracks.joints(frame);
            numbers.extend(joints.iter().flat_map(|joint| joint.to_array()));
        }
        let names = JOINTS.map(str::to_owned).to_vec();
        Self::new(names, &numbers, markers.frame_rate)
    }
}

/// Trajectories of the markers of the set.
struct MarkerTracks {
    waist: [Vec<DVec3>; 4],
    head: Vec<Vec<DVec3>>,
    neck: [Vec<DVec3>; 2],
    chest: [Vec<DVec3>; 2],
    /// Knee, ankle, toe, shoulder, elbow, wrist and wrist, left and right.
    sides: [[Vec<DVec3>; 7]; 2],
}

impl MarkerTracks {
    fn of(markers: &MarkerCapture) -> Result<Self, RetargetError> {
        let mut missing = Vec::new();
        let mut track = |side: &str, names: MarkerNames| -> Vec<DVec3> {
            let full: Vec<String> = names.iter().map(|name| format!("{side}{name}")).collect();
            let found = full
                .iter()
                .find_map(|name| markers.filled(markers.marker(name)?));
            found.unwrap_or_else(|| {
                missing.push(full.join(" or "));
                Vec::new()
            })
        };
        let waist = WAIST.map(|names| track("", names));
        let head = HEAD.map(|names| track("", names)).to_vec();
        let neck = NECK.map(|names| track("", names));
        let chest = CHEST.map(|names| track("", names));
        let sides = ["L", "R"].map(|side| {
            [KNEE, ANKLE, TOE, SHOULDER, ELBOW, WRIST[0], WRIST[1]].map(|names| track(side, names))
        });
        match missing.is_empty() {
            true => Ok(Self {
                waist,
                head,
                neck,
                chest,
                sides,
            }),
            false => Err(RetargetError::MissingMarkers {
                missing: missing.join(", "),
                markers: markers.names.join(", "),
            }),
        }
    }

    /// Joint centres at a frame, in the order of [`JOINTS`].
    fn joints(&self, frame: usize) -> [DVec3; JOINTS.len()] {
        let waist = [0, 1, 2, 3].map(|marker| self.waist[marker][frame]);
        let front = 0.5 * (waist[0] + waist[1]);
        let back = 0.5 * (waist[2] + waist[3]);
        let width = waist[0].distance(waist[1]);
        let left = (waist[0] - waist[1]).normalize_or_zero();
        let backward = (back - front)
            .reject_from(left_or_x(left))
            .normalize_or_zero();
        let up = left.cross(backward);
        let hip =
            |side: f64| front + width * (side * HIP[0] * left + HIP[1] * backward - HIP[2] * up);
        let hips = [hip(1.0), hip(-1.0)];
        let mean = |tracks: &[Vec<DVec3>]| {
            let sum: DVec3 = tracks.iter().map(|track| track[frame]).sum();
            sum / tracks.len() as f64
        };
        let (neck, chest) = (mean(&self.neck), mean(&self.chest));
        let down = (chest - neck).normalize_or_zero();
        let side = |side: usize| {
            let marker = |index: usize| self.sides[side][index][frame];
            let inward = if side == 0 { -left } else { left };
            let knee = marker(0) + width * KNEE_INWARD * inward;
            let ankle = marker(1) + width * ANKLE_INWARD * inward;
            let shoulder = marker(3) + width * SHOULDER_DOWN * down;
            let wrist = 0.5 * (marker(5) + marker(6));
            // The marker is on the outer side, away from the trunk.
            let arm =
                (neck - marker(4)).reject_from(left_or_x((wrist - shoulder).normalize_or_zero()));
            let elbow = marker(4) + width * ELBOW_INWARD * arm.normalize_or_zero();
            [knee, ankle, marker(2), shoulder, elbow, wrist]
        };
        let (l, r) = (side(0), side(1));
        let pelvis = 0.5 * (hips[0] + hips[1]);
        [
            pelvis,
            chest,
            neck,
            mean(&self.head),
            hips[0],
            hips[1],
            l[0],
            r[0],
            l[1],
            r[1],
            l[2],
            r[2],
            l[3],
            r[3],
            l[4],
            r[4],
            l[5],
            r[5],
        ]
    }
}

/// The direction, or x if it is zero.
fn left_or_x(direction: DVec3) -> DVec3 {
    match direction == DVec3::ZERO {
        true => DVec3::X,
        false => direction,
    }
}
