//! Report of frame poses, as text and JSON.

use kinopt::spatial::{Placement, Quaternion};
use serde::{Serialize, Serializer};

use crate::number_format::{LengthFormat, six_digits};
use crate::table::Table;

/// Placement of a frame in the world, or in another frame.
#[derive(Debug, Serialize)]
pub(crate) struct FramePlacement {
    position: [f64; 3],
    /// Components w, x, y, z with w ≥ 0.
    quaternion: [f64; 4],
    /// Tail of the bone, for a rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    tail: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tip: Option<[f64; 3]>,
}

/// Frames by name, in the requested order.
#[derive(Debug)]
pub(crate) struct FrameReport(Vec<(String, FramePlacement)>);

impl Serialize for FrameReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, placement)| (name, placement)))
    }
}

/// Quaternion of a rotation with w ≥ 0.
fn quaternion(placement: &Placement<f64>) -> [f64; 4] {
    let Quaternion { w, v } = Quaternion::from_matrix(&placement.rotation);
    let quaternion = [w, v.x, v.y, v.z];
    // Adding zero changes −0 to 0.
    quaternion.map(|c| if w < 0.0 { -c + 0.0 } else { c + 0.0 })
}

impl From<&Placement<f64>> for FramePlacement {
    fn from(placement: &Placement<f64>) -> Self {
        Self {
            position: placement.translation.to_array(),
            quaternion: quaternion(placement),
            tail: None,
            tip: None,
        }
    }
}

/// Placement of a frame; for a bone also those of its tail and tip.
pub(crate) type Placed = (Placement<f64>, Option<[Placement<f64>; 2]>);

impl FrameReport {
    /// Report of the named frames, placed by `placed`, in the world or in the frame `base`.
    pub(crate) fn new<E>(
        names: &[impl AsRef<str>],
        base: Option<&str>,
        placed: impl Fn(&str) -> Result<Placed, E>,
    ) -> Result<Self, E> {
        let base = base.map(&placed).transpose()?;
        let base_from_world = base.map(|(placement, _)| placement.inverse());
        let in_base = |placement| match base_from_world {
            Some(base_from_world) => base_from_world * placement,
            None => placement,
        };
        let frames = names.iter().map(|name| {
            let name = name.as_ref();
            let (placement, ends) = placed(name)?;
            let placement = in_base(placement);
            let ends = ends.map(|ends| ends.map(|end| in_base(end).translation.to_array()));
            let placement = FramePlacement {
                position: placement.translation.to_array(),
                quaternion: quaternion(&placement),
                tail: ends.map(|[tail, _]| tail),
                tip: ends.map(|[_, tip]| tip),
            };
            Ok((name.to_owned(), placement))
        });
        Ok(Self(frames.collect::<Result<_, E>>()?))
    }

    /// Aligned table.
    pub(crate) fn text(&self, format: LengthFormat) -> String {
        let rigs = self.0.iter().any(|(_, placement)| placement.tip.is_some());
        let tip = match rigs {
            true => "| >tip x | >tip y | >tip z",
            false => "",
        };
        let columns = format!("frame | >x | >y | >z | >qw | >qx | >qy | >qz {tip}");
        let mut table = Table::new(&columns);
        for (name, placement) in &self.0 {
            let mut row = vec![name.clone()];
            row.extend(format.vector(placement.position));
            row.extend(placement.quaternion.map(six_digits));
            row.extend(placement.tip.into_iter().flat_map(|tip| format.vector(tip)));
            table.row(row);
        }
        table.text()
    }
}
