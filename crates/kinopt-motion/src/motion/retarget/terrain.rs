//! Terrain under a retargeted motion: steps and slopes.

use serde::{Deserialize, Serialize};

use super::RetargetError;
use kinopt_kinematics::bad_option::{BadOption, POSITIVE, Range};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::Vector3;

/// Allowed slopes of the ground, and allowed coordinates.
const SLOPE_RANGE: Range = (|v| v.abs() <= 1.0, "within [-1, 1] rad");
const COORDINATE_RANGE: Range = (|v| v.abs() <= 1e6, "within [-1e6, 1e6] m");

/// Rectangle of ground in the world of the model, such as the top of a step or a ramp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TerrainPatch {
    /// Centre of the surface, metres.
    pub centre: [f64; 3],
    /// Horizontal lengths along the heading and across it, metres.
    pub size: [f64; 2],
    /// Angle of the heading from the x axis about the z axis, radians.
    #[serde(default)]
    pub heading: f64,
    /// Angle by which the surface rises along its heading, radians.
    #[serde(default)]
    pub slope: f64,
}

/// Level ground at height 0 with patches at other heights or slopes. The highest patch at a position counts.
///
/// ```
/// use kinopt::motion::retarget::Terrain;
///
/// let text = r#"{"patches": [{"centre": [1.0, 0.0, 0.2], "size": [1.0, 2.0]}]}"#;
/// let terrain = Terrain::from_json(text)?;
/// assert_eq!((terrain.height(0.2, 0.0), terrain.height(0.8, 0.0)), (0.0, 0.2));
/// # Ok::<(), kinopt::motion::retarget::RetargetError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terrain {
    patches: Vec<TerrainPatch>,
}

/// Plane under a foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GroundPlane {
    /// Height at the origin of the world, metres, and slopes along x and y.
    height: f64,
    slopes: [f64; 2],
}

impl GroundPlane {
    pub(super) const LEVEL: Self = Self {
        height: 0.0,
        slopes: [0.0; 2],
    };

    /// Returns the height at a position, metres.
    pub(super) fn height(&self, x: f64, y: f64) -> f64 {
        self.height + self.slopes[0] * x + self.slopes[1] * y
    }

    /// Upward normal.
    pub(super) fn normal(&self) -> Vector3<f64> {
        let normal = Vector3::new(-self.slopes[0], -self.slopes[1], 1.0);
        normal * (1.0 / normal.norm())
    }
}

impl TerrainPatch {
    fn plane(&self) -> GroundPlane {
        let (sin, cos) = elementary::sin_cos(self.heading);
        let (rise, run) = elementary::sin_cos(self.slope);
        let slopes = [cos * rise / run, sin * rise / run];
        let [x, y, z] = self.centre;
        GroundPlane {
            height: z - slopes[0] * x - slopes[1] * y,
            slopes,
        }
    }

    fn contains(&self, x: f64, y: f64) -> bool {
        let (sin, cos) = elementary::sin_cos(self.heading);
        let (x, y) = (x - self.centre[0], y - self.centre[1]);
        let (along, across) = (cos * x + sin * y, cos * y - sin * x);
        along.abs() <= 0.5 * self.size[0] && across.abs() <= 0.5 * self.size[1]
    }

    fn check(&self) -> Result<(), BadOption> {
        for coordinate in self.centre {
            BadOption::check("centre", coordinate, COORDINATE_RANGE)?;
        }
        for length in self.size {
            BadOption::check("size", length, POSITIVE)?;
        }
        BadOption::check("heading", self.heading, COORDINATE_RANGE)?;
        BadOption::check("slope", self.slope, SLOPE_RANGE)
    }
}

impl Terrain {
    /// Creates a terrain from its patches.
    ///
    /// # Errors
    /// Returns an error if a number is out of its range: sizes above 0, slopes within ±1 rad.
    pub fn new(patches: Vec<TerrainPatch>) -> Result<Self, RetargetError> {
        patches.iter().try_for_each(TerrainPatch::check)?;
        Ok(Self { patches })
    }

    /// Parses a terrain from JSON: `{"patches": [{"centre": [1, 0, 0.2], "size": [1, 2], "heading": 0, "slope": 0.1}]}`.
    /// Heading and slope are 0 by default.
    ///
    /// # Errors
    /// Returns an error, with its position, if the text is malformed. Returns the errors of [`new`](Self::new).
    pub fn from_json(text: &str) -> Result<Self, RetargetError> {
        let parsed: Self = serde_json::from_str(text)
            .map_err(|error| RetargetError::Terrain(error.to_string()))?;
        Self::new(parsed.patches)
    }

    /// Patches of the terrain.
    #[must_use]
    pub fn patches(&self) -> &[TerrainPatch] {
        &self.patches
    }

    /// Returns the height of the ground at a position, metres.
    #[must_use]
    pub fn height(&self, x: f64, y: f64) -> f64 {
        self.plane(&[(x, y)]).height(x, y)
    }

    /// Returns the plane on which a foot with points at some positions is in contact: the highest under any of them.
    pub(super) fn plane(&self, positions: &[(f64, f64)]) -> GroundPlane {
        let under = positions.iter().flat_map(|&(x, y)| {
            let patches = self
                .patches
                .iter()
                .filter(move |patch| patch.contains(x, y));
            patches.map(move |patch| (patch.plane(), patch.plane().height(x, y)))
        });
        let highest = under.max_by(|a, b| a.1.total_cmp(&b.1));
        // A pit counts only if the whole foot is above it.
        let is_pit = positions
            .iter()
            .any(|&(x, y)| self.patches.iter().all(|patch| !patch.contains(x, y)));
        match highest {
            Some((plane, height)) if height >= 0.0 || !is_pit => plane,
            _ => GroundPlane::LEVEL,
        }
    }
}
