//! Merging of the parts of a map.

use super::ReachMap;
use super::data::{ABSENT, EXCLUDED, ReachMapData};
use super::error::ReachMapError;

impl ReachMap {
    /// Joins [parts](super::ReachMapBuilder::with_part) of one map. The order of the parts does not matter.
    ///
    /// All parts together are bitwise the map that is built at once.
    ///
    /// # Errors
    /// Returns an error for parts of maps of other arms or grids, for a part that occurs twice, and for no parts.
    pub fn merged(parts: &[Self]) -> Result<Self, ReachMapError> {
        let first = &parts.first().ok_or(ReachMapError::NotParts)?.data;
        for (index, part) in parts.iter().enumerate() {
            let other = &part.data;
            first.arm.check(&other.arm)?;
            let properties = [
                ("position_step", first.position_step == other.position_step),
                (
                    "number of cubes",
                    first.cubes_per_axis == other.cubes_per_axis,
                ),
                (
                    "orientation_step",
                    first.bins_per_face == other.bins_per_face,
                ),
            ];
            if let Some((property, _)) = properties.iter().find(|(_, is_equal)| !is_equal) {
                return Err(ReachMapError::OtherGrid { index, property });
            }
        }
        let mut data = ReachMapData {
            arm: first.arm.clone(),
            cubes: vec![ABSENT; first.cubes.len()],
            cells: Vec::new(),
            configurations: Vec::new(),
            ..*first
        };
        for cube in 0..data.cubes.len() {
            let mut owners = parts.iter().filter(|part| part.data.cubes[cube] != ABSENT);
            let owner = owners.next();
            if owners.next().is_some() {
                return Err(ReachMapError::NotParts);
            }
            data.cubes[cube] = match owner {
                None => ABSENT,
                Some(part) if part.data.cubes[cube] == EXCLUDED => EXCLUDED,
                Some(part) => data.copy_block(&part.data, part.data.cubes[cube]),
            };
        }
        Ok(Self { data })
    }
}

impl ReachMapData {
    /// Appends a block of cells of another map and returns its new number.
    fn copy_block(&mut self, other: &Self, block: u32) -> u32 {
        let (bins, joints) = (self.bins().count(), self.arm.joints.len());
        let from = block as usize * bins;
        let mut codes = Vec::new();
        let rows: Vec<u32> = other.cells[from..from + bins]
            .iter()
            .map(|&row| match row {
                super::data::UNREACHABLE | super::data::UNKNOWN => row,
                row => {
                    let row = row as usize * joints;
                    codes.extend_from_slice(&other.configurations[row..row + joints]);
                    (codes.len() / joints - 1) as u32
                }
            })
            .collect();
        self.add_block(&rows, &codes)
    }
}
