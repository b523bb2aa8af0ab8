//! Static balance: the centre of mass is above the support polygon.

use super::by_dual_numbers::moved_by_unit_twists;
use super::centre_of_mass::Body;
use super::convex_polygon::{ConvexPolygon, Point2};
use super::residual::{check_finite, error_if};
use super::{
    Description, Extensions, Inequality, InequalityResidual, Inputs, LocalJacobian, Quantity,
    Residual, RowBlock,
};
use kinopt_kinematics::model::{FrameId, Masses};
use kinopt_kinematics::scalar::{Dual, Scalar};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = c − P(c): the vector to the centre of mass c from the closest point P(c) of the support polygon.
///
/// Both are projected along the vertical. The polygon is the convex hull of the support points, less a
/// [margin](Self::with_margin) from its edges. Two rows in metres, perpendicular to the vertical; zero inside the
/// polygon. Support points may be on moving frames.
///
/// A body at rest then balances on level feet with enough friction (Bretl & Lall 2008, "Testing static equilibrium for
/// legged robots").
///
/// ```
/// # use kinopt::kinematics::centre_of_mass;
/// # use kinopt::model::{Limits, Masses, Model, PointMass};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{Point, SupportPolygon};
/// # use kinopt::{Problem, Solver};
/// # let mut builder = Model::builder("crane");
/// # let (y, still) = (Vector3::UNITS[1], Placement::identity());
/// # let link = Placement::translation([0.0, 0.0, 1.0].into());
/// # let turns = Limits::new(-2.0, 2.0);
/// # let ankle = builder.revolute("ankle", None, still, y, turns);
/// # let hip = builder.revolute("hip", Some(ankle), link, y, turns);
/// # let elbow = builder.revolute("elbow", Some(hip), link, y, turns);
/// # let waist = builder.frame("waist", Some(ankle), link);
/// # let chest = builder.frame("chest", Some(hip), link);
/// # let hand = builder.frame("hand", Some(elbow), link);
/// # let model = builder.build()?;
/// let body = [(waist, 3.0), (chest, 1.0), (hand, 1.0)];
/// let body = body.map(|(frame, mass)| PointMass { frame, at: Vector3::zero(), mass });
/// let masses = Masses::new(&model, body)?;
/// let sole = [[-0.1, 0.1], [-0.1, -0.1], [0.2, -0.1], [0.2, 0.1]].map(|[x, y]| [x, y, 0.0]);
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Point::new(hand, [1.0, 0.0, 1.5]));
/// tasks.add(SupportPolygon::new(&masses).with_points(sole).with_margin(0.05));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.1, 0.2, 0.3])?;
/// assert!(solution.reached, "{}", solution.explain());
/// assert!(centre_of_mass(&model, &masses, &solution.q)?.x < 0.15 + 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SupportPolygon {
    body: Body,
    points: Vec<Support>,
    /// The frames with support points; they follow the frames of the masses.
    frames: Vec<FrameId>,
    margin: f64,
    up: Vector3<f64>,
    /// The polygon reduced by the margin, if no support point is on a frame; `None` otherwise.
    fixed_polygon: Option<ConvexPolygon<f64>>,
}

/// A support point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Support {
    /// Index of the frame that carries it; `None` for the world.
    frame: Option<usize>,
    position: Vector3<f64>,
}

impl SupportPolygon {
    /// A task for the centre of these masses without support points; the vertical is z.
    #[must_use]
    pub fn new(masses: &Masses) -> Self {
        Self {
            body: Body::of(masses),
            points: Vec::new(),
            frames: Vec::new(),
            margin: 0.0,
            up: Vector3::UNITS[2],
            fixed_polygon: None,
        }
    }

    /// Sets the vertical in the world, of any length except zero.
    #[must_use]
    pub fn with_up(mut self, up: impl Into<Vector3<f64>>) -> Self {
        self.up = up.into();
        self.update_fixed_polygon();
        self
    }

    /// Sets the distance from the polygon's edges, metres.
    ///
    /// If moving frames leave no point inside the margin, the target is the mean of the support points.
    #[must_use]
    pub fn with_margin(mut self, margin: f64) -> Self {
        self.margin = margin;
        self.update_fixed_polygon();
        self
    }

    /// Adds support points, metres in the world.
    #[must_use]
    pub fn with_points<P: Into<Vector3<f64>>>(
        mut self,
        points: impl IntoIterator<Item = P>,
    ) -> Self {
        let points = points.into_iter().map(|position| Support {
            frame: None,
            position: position.into(),
        });
        self.points.extend(points);
        self.update_fixed_polygon();
        self
    }

    /// Adds support points on a frame, in the frame's coordinates, metres: for example the corners of a foot's sole.
    #[must_use]
    pub fn with_points_on<P: Into<Vector3<f64>>>(
        mut self,
        frame: FrameId,
        points: impl IntoIterator<Item = P>,
    ) -> Self {
        let known = self
            .frames
            .iter()
            .position(|known_frame| *known_frame == frame);
        let slot = known.unwrap_or(self.frames.len());
        if known.is_none() {
            self.frames.push(frame);
        }
        let points = points.into_iter().map(|position| Support {
            frame: Some(slot),
            position: position.into(),
        });
        self.points.extend(points);
        self.update_fixed_polygon();
        self
    }

    /// Computes the constant polygon, if no support point moves.
    fn update_fixed_polygon(&mut self) {
        let axes = self.horizontal_axes();
        self.fixed_polygon = self.frames.is_empty().then(|| {
            let project = |point: &Support| axes.map(|axis| axis.dot(point.position));
            ConvexPolygon::around(self.points.iter().map(project)).shrunk(self.margin)
        });
    }

    /// Two axes perpendicular to the vertical; with it they are right-handed.
    fn horizontal_axes(&self) -> [Vector3<f64>; 2] {
        let up = self.up * (1.0 / self.up.norm());
        let [x, y, z] = Vector3::UNITS;
        // For a vertical along z these are x and y, so that the rows are in x and y.
        let reference = if up.dot(z).abs() > 0.5 { x } else { z };
        let first = reference - up * reference.dot(up);
        let first = first * (1.0 / first.norm());
        match up == y {
            true => [z, x],
            false => [first, up.cross(first)],
        }
    }

    /// The rows from the centre and the frames with support points; NaN for SIMD lanes, which no problem uses.
    fn offset_outside<S: Scalar>(&self, centre: Vector3<S>, frames: &[Placement<S>]) -> [S; 2] {
        let axes = self.horizontal_axes().map(Vector3::constant);
        if let Some(fixed_polygon) = &self.fixed_polygon {
            return fixed_polygon.constant_offset_outside(axes.map(|axis| axis.dot(centre)));
        }
        let projected = axes.map(|axis| axis.dot(centre));
        self.polygon(frames)
            .shrunk(self.margin)
            .offset_outside(projected)
    }

    /// Writes the slack of the centre in each edge, less the margin, by the point that starts the edge.
    fn slacks<S: Scalar>(&self, centre: Vector3<S>, frames: &[Placement<S>], slacks: &mut [S]) {
        let axes = self.horizontal_axes().map(Vector3::constant);
        let projected = axes.map(|axis| axis.dot(centre));
        self.polygon(frames).slacks(projected, self.margin, slacks);
    }

    /// The convex hull of the support points, projected along the vertical.
    fn polygon<S: Scalar>(&self, frames: &[Placement<S>]) -> ConvexPolygon<S> {
        let axes = self.horizontal_axes().map(Vector3::constant);
        let project = |position: Vector3<S>| -> Point2<S> { axes.map(|axis| axis.dot(position)) };
        ConvexPolygon::around(self.points.iter().map(|point| {
            let position = Vector3::constant(point.position);
            project(match point.frame {
                Some(frame) => frames[frame].apply(position),
                None => position,
            })
        }))
    }

    /// Differentiates rows that `write` computes from the centre and the feet.
    ///
    /// Differentiates by the centre once instead of by each of its parts, then by the feet.
    fn differentiate_by(
        &self,
        frames: &[Placement<f64>],
        jacobian: &mut LocalJacobian,
        (rows, slopes): (&mut [Dual<6>], &mut [Vector3<f64>]),
        write: impl Fn(Vector3<Dual<6>>, &[Placement<Dual<6>>], &mut [Dual<6>]),
    ) {
        let (parts, feet) = frames.split_at(self.body.frames.len());
        let centre = self.body.centre(parts);
        let mut dual_feet: Vec<Placement<Dual<6>>> = feet.iter().map(Placement::constant).collect();
        let variable = |value, axis| Dual::<6>::variable(value, axis);
        let dual_centre = Vector3::new(
            variable(centre.x, 0),
            variable(centre.y, 1),
            variable(centre.z, 2),
        );
        write(dual_centre, &dual_feet, rows);
        for (slope, row) in slopes.iter_mut().zip(&*rows) {
            let [x, y, z, ..] = row.derivatives();
            *slope = Vector3::new(x, y, z);
        }
        if feet.is_empty() && slopes.iter().all(|slope| slope.to_array() == [0.0; 3]) {
            return;
        }
        self.body.differentiate(parts, slopes, jacobian);
        let centre = Vector3::constant(centre);
        for (k, foot) in feet.iter().enumerate() {
            dual_feet[k] = moved_by_unit_twists(foot);
            write(centre, &dual_feet, rows);
            let slot = parts.len() + k;
            for (row, slope) in rows.iter().enumerate() {
                let [vx, vy, vz, wx, wy, wz] = slope.derivatives();
                jacobian.linear_mut(slot)[row] = Vector3::new(vx, vy, vz);
                jacobian.angular_mut(slot)[row] = Vector3::new(wx, wy, wz);
            }
            dual_feet[k] = Placement::constant(foot);
        }
    }
}

impl Residual for SupportPolygon {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        let parts = self.body.frames.iter();
        Inputs::frames(parts.chain(&self.frames).copied())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let (parts, feet) = frames.split_at(self.body.frames.len());
        residual.copy_from_slice(&self.offset_outside(self.body.centre(parts), feet));
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let (mut rows, mut slopes) = ([Dual::zero(); 2], [Vector3::zero(); 2]);
        let buffers = (&mut rows[..], &mut slopes[..]);
        self.differentiate_by(frames, jacobian, buffers, |centre, feet, rows| {
            rows.copy_from_slice(&self.offset_outside(centre, feet));
        });
        true
    }

    fn description(&self) -> Description {
        Description::new("support polygon")
            .of_body()
            .with_validity(self.validate())
    }
}

impl SupportPolygon {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("the vertical", self.up.to_array())?;
        error_if(self.up.norm() <= 0.0, || {
            "its vertical has no direction".to_owned()
        })?;
        let coordinates = self
            .points
            .iter()
            .flat_map(|point| point.position.to_array());
        check_finite("its points of support", coordinates)?;
        error_if(self.points.is_empty(), || {
            "it has no points of support".to_owned()
        })?;
        let margin = self.margin;
        error_if(!(margin >= 0.0 && margin.is_finite()), || {
            format!("its margin {margin} m is not a number of at least 0")
        })?;
        if !self.frames.is_empty() {
            return Ok(());
        }
        let axes = self.horizontal_axes();
        let project = |point: &Support| axes.map(|axis| axis.dot(point.position));
        let polygon = ConvexPolygon::around(self.points.iter().map(project));
        error_if(!polygon.contains_margin(margin), || {
            format!("its margin {margin} m leaves nothing of its polygon")
        })
    }
}

impl InequalityResidual for SupportPolygon {
    /// The polygon; one slack for each support point, finite for corners.
    fn inequalities(&self) -> Vec<Inequality> {
        vec![Inequality::new(0..2, self.points.len())]
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], slacks: &mut [S]) {
        let (parts, feet) = frames.split_at(self.body.frames.len());
        Self::slacks(self, self.body.centre(parts), feet, slacks);
    }

    fn differentiate_slacks(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let edges = jacobian.rows();
        let (mut rows, mut slopes) = (vec![Dual::zero(); edges], vec![Vector3::zero(); edges]);
        let buffers = (&mut rows[..], &mut slopes[..]);
        self.differentiate_by(frames, jacobian, buffers, |centre, feet, slacks| {
            Self::slacks(self, centre, feet, slacks);
        });
        true
    }
}
