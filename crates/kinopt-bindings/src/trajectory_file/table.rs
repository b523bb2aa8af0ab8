//! Tables of configurations over time: .npz, .json and .csv.

use std::fmt::Write;
use std::path::Path;

use kinopt::io::WriteError;
use serde::Serialize;

use super::TrajectoryFormat;
use super::npz::{Column, npz};

/// Frame rate and contacts of a retargeted motion.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Samples per second.
    pub frame_rate: f64,
    /// Names of the frames that make contact.
    pub frames: Vec<String>,
    /// Contact point of each frame, in its coordinates, metres.
    pub points: Vec<[f64; 3]>,
    /// Contact flags, sample by sample.
    pub flags: Vec<bool>,
}

/// Configurations over time, for files.
#[derive(Clone, Copy, Debug)]
pub struct TrajectoryTable<'a> {
    /// Names of the numbers of a configuration.
    pub names: &'a [String],
    /// Sample times, seconds.
    pub times: &'a [f64],
    /// Configurations, one after another, radians and metres.
    pub q: &'a [f64],
    /// Frame rate and contacts of a retargeted motion; `None` for other trajectories.
    pub contacts: Option<&'a Contacts>,
    /// True if the configurations begin with a free base: position and quaternion w, x, y, z.
    pub is_free: bool,
    /// Layout of bare rows and of .npz files.
    pub layout: TableLayout,
}

/// Layout of configurations for other programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableLayout {
    /// Bare .csv rows of Unitree's retargeted LAFAN1: x, y, z, quaternion x, y, z, w, joints. A .npz has `q`.
    #[default]
    Lafan1,
    /// MuJoCo's `qpos`: the quaternion is w, x, y, z, in .csv rows without a header and in `qpos` of a .npz.
    Mujoco,
}

impl TableLayout {
    /// Layouts by name.
    pub const ALL: [(&'static str, Self); 2] = [("lafan1", Self::Lafan1), ("mujoco", Self::Mujoco)];
}

/// Content of a .json file.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    fps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    times: Option<&'a [f64]>,
    names: &'a [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_frames: Option<&'a [String]>,
    /// Contact points in the coordinates of their frames, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_points: Option<&'a [[f64; 3]]>,
    q: Vec<&'a [f64]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contacts: Option<Vec<&'a [bool]>>,
}

impl<'a> TrajectoryTable<'a> {
    /// Writes a table. A .csv file has a header row with `header`; without it, a retargeted motion has bare
    /// configurations. The file appears once it is complete.
    ///
    /// # Errors
    /// A [`WriteError`] with the file's name, also for .bvh and .glb, which need bones.
    pub fn write(
        &self,
        format: TrajectoryFormat,
        header: bool,
        path: &Path,
    ) -> Result<(), WriteError> {
        let bytes = self.to_bytes(format, header);
        let bytes = bytes.map_err(|problem| WriteError::new(path, problem))?;
        kinopt::io::write_file(path, &bytes)
    }

    fn to_bytes(self, format: TrajectoryFormat, header: bool) -> std::io::Result<Vec<u8>> {
        match format {
            TrajectoryFormat::Json => Ok(serde_json::to_vec(&self.document())?),
            TrajectoryFormat::Csv if header => Ok(self.with_header().into_bytes()),
            TrajectoryFormat::Csv => Ok(self.bare_rows().into_bytes()),
            TrajectoryFormat::Npz => self.arrays(),
            TrajectoryFormat::Bvh | TrajectoryFormat::Glb => Err(std::io::Error::new(
                std::io::ErrorKind::InvalidInput,
                ".bvh needs a figure with bones, and .glb a figure or a robot; use .npz, .json or .csv",
            )),
        }
    }

    fn rows(self) -> impl ExactSizeIterator<Item = &'a [f64]> {
        self.q.chunks_exact(self.names.len().max(1))
    }

    /// Contact flags of a sample.
    fn in_contact(self, sample: usize) -> &'a [bool] {
        let contacts = self.contacts.map(|contacts| {
            let width = contacts.frames.len();
            contacts.flags.get(sample * width..(sample + 1) * width)
        });
        contacts.flatten().unwrap_or_default()
    }

    fn arrays(self) -> std::io::Result<Vec<u8>> {
        let (samples, width) = (self.rows().len(), self.names.len());
        let name = match self.layout {
            TableLayout::Lafan1 => "q",
            TableLayout::Mujoco => "qpos",
        };
        let q = (name, &[samples, width][..], Column::Numbers(self.q));
        let names = ("names", &[width][..], Column::Words(self.names));
        let Some(contacts) = self.contacts else {
            let times = ("times", &[samples][..], Column::Numbers(self.times));
            return npz(&[q, times, names]);
        };
        let count = contacts.frames.len();
        let rate = [contacts.frame_rate];
        npz(&[
            q,
            ("fps", &[], Column::Numbers(&rate)),
            names,
            (
                "contacts",
                &[samples, count],
                Column::Flags(&contacts.flags),
            ),
            ("contact_frames", &[count], Column::Words(&contacts.frames)),
            (
                "contact_points",
                &[count, 3],
                Column::Numbers(contacts.points.as_flattened()),
            ),
        ])
    }

    fn document(self) -> Document<'a> {
        let contacts = self.contacts;
        let flags = |_| (0..self.rows().len()).map(|sample| self.in_contact(sample));
        Document {
            fps: contacts.map(|contacts| contacts.frame_rate),
            times: contacts.is_none().then_some(self.times),
            names: self.names,
            contact_frames: contacts.map(|contacts| &*contacts.frames),
            contact_points: contacts.map(|contacts| &*contacts.points),
            q: self.rows().collect(),
            contacts: contacts.map(flags).map(Iterator::collect),
        }
    }

    /// Rows of configurations. In the layout of LAFAN1 the base's quaternion is x, y, z, w.
    fn bare_rows(self) -> String {
        let mut text = String::new();
        for q in self.rows() {
            let mut row = q.to_vec();
            let is_last = self.is_free && self.layout == TableLayout::Lafan1;
            if let Some(quaternion) = row.get_mut(3..7).filter(|_| is_last) {
                quaternion.rotate_left(1);
            }
            let row: Vec<String> = row.iter().map(ToString::to_string).collect();
            text += &row.join(",");
            text.push('\n');
        }
        text
    }

    /// Header row, then one row for each sample: time in seconds, configuration, and contact flags (1 in contact).
    fn with_header(self) -> String {
        let contact_frames = self
            .contacts
            .map_or(&[][..], |contacts| contacts.frames.as_slice());
        let contact_columns = contact_columns(contact_frames);
        let columns = std::iter::once("time".to_owned())
            .chain(self.names.iter().cloned())
            .chain(contact_columns);
        let mut text = columns.collect::<Vec<_>>().join(",") + "\n";
        for (sample, (time, q)) in self.times.iter().zip(self.rows()).enumerate() {
            // Writing into a string cannot fail.
            let _ = write!(text, "{time}");
            for number in q {
                let _ = write!(text, ",{number}");
            }
            for in_contact in self.in_contact(sample) {
                let _ = write!(text, ",{}", u8::from(*in_contact));
            }
            text.push('\n');
        }
        text
    }
}

/// Names of the contact columns. A frame with several contact points has numbered columns from its second point on.
fn contact_columns(frames: &[String]) -> Vec<String> {
    let name = |(column, frame): (usize, &String)| {
        let earlier = frames[..column].iter().filter(|other| *other == frame);
        match earlier.count() {
            0 => format!("{frame} in contact"),
            count => format!("{frame} in contact {}", count + 1),
        }
    };
    frames.iter().enumerate().map(name).collect()
}
