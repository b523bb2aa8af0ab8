//! Complete solution sets of six revolute joints, as angles without limits.

use super::angle::Angle;
use super::argument::Argument;
use super::branches::{ArmBranch, BranchSigns};
use super::elimination::{Elimination, Numbering};
use super::polish::{ClosureError, closure_error, null_direction, polish};
use super::screw::Screw;
use super::spherical_wrist::SphericalWrist;
use super::three_parallel::ThreeParallel;
use crate::simd_ik::Chain;
use kinopt_kinematics::random::RandomStream;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Tolerance of intersecting and parallel axes, lengths of the arm and radians.
///
/// A robot file states right angles by decimal numbers. Every candidate is polished on the true axes.
const STRUCTURE_TOLERANCE: f64 = 2e-5;
/// Largest difference of two candidates of one solution, radians.
const SAME_SOLUTION: f64 = 1e-5;
/// Error below which a polished candidate is a root, lengths of the arm and radians.
const ROOT_ERROR: f64 = 1e-10;
/// Smallest distance of a configuration within the tolerances that is no root from a solution, radians.
///
/// Near a singular pose a whole valley of configurations is within the tolerances.
const VALLEY: f64 = 0.1;
/// Error above which a candidate of an elimination is dropped, lengths of the arm and radians.
const MAX_CANDIDATE_ERROR: f64 = 0.3;
/// Distances of the candidates next to a nearly singular root, radians.
const TWIN_DISTANCES: [f64; 4] = [-0.1, -0.01, 0.01, 0.1];
/// Largest difference of a simple root of the polynomial from the joint of its solution, radians.
const ROOT_DISTANCE: f64 = 0.01;
/// Error below which a polished candidate that is no root may be halfway between two, lengths of the arm and radians.
const MAX_TWIN_ERROR: f64 = 1e-3;
/// Number of numberings of an arm without a closed form.
const NUMBERINGS: usize = 4;
/// Sizes of the perturbation among which an arm chooses, lengths of the arm and radians.
const PERTURBATIONS: [f64; 3] = [1e-7, 1e-6, 0.0];
/// Number of poses that rate a numbering.
const RATED_POSES: usize = 12;
/// Numberings whose roots are worse than this at the median pose are left out, radians.
const MAX_ROOT_ERROR: f64 = 0.05;

/// Solver by the structure of the axes.
#[derive(Clone, Debug)]
enum SolutionMethod {
    SphericalWrist(Box<SphericalWrist>),
    ThreeParallel(Box<ThreeParallel>),
    /// Numberings, best conditioned first.
    Elimination(Vec<Elimination>),
}

/// Numberings and perturbations of an arm without a closed form, best conditioned first.
#[derive(Clone, Debug, Default)]
pub(super) struct MethodChoice {
    eliminations: Vec<(Numbering, f64)>,
}

/// Compiled solver of six revolute joints.
#[derive(Clone, Debug)]
pub(crate) struct SixRevolute {
    /// Axes at zero joint values, in the base frame, lengths of the arm.
    axes: [Screw; 6],
    /// Pose of the tool at zero joint values, inverted, lengths of the arm.
    tool_from_base: Placement<f64>,
    /// Position of the tool at zero joint values, lengths of the arm.
    tool: Vector3<f64>,
    /// Length of the arm, metres.
    length: f64,
    /// True if the structure is that of the chain from tool to base.
    reversed: bool,
    method: SolutionMethod,
    branch_signs: Option<BranchSigns>,
}

/// Buffers and results of one target.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolutionSet {
    candidates: Vec<[Angle; 6]>,
    /// Solutions within (−π, π], radians.
    pub(crate) solutions: Vec<SetMember>,
    /// True if all isolated solutions are found.
    pub(crate) complete: bool,
    /// True if there is a continuous family of solutions.
    pub(crate) family: bool,
    /// Deviation of the univariate polynomial.
    deviation: f64,
    /// Angles of the solutions, and errors of those that are no roots.
    roots: Vec<[Angle; 6]>,
    near: Vec<([Angle; 6], ClosureError)>,
}

/// Solution of a set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetMember {
    /// Joint values within (−π, π].
    pub(crate) q: [f64; 6],
    /// Position error, metres.
    pub(crate) position_error: f64,
    /// Orientation error, radians.
    pub(crate) orientation_error: f64,
    pub(crate) branch: ArmBranch,
}

impl SixRevolute {
    /// Compiles the solver; `None` unless the chain has six revolute joints.
    pub(crate) fn new(chain: &Chain) -> Option<Self> {
        let joints = chain.joints();
        if joints.len() != 6 || joints.iter().any(|joint| !joint.kind.turns()) {
            return None;
        }
        let length = chain.extent();
        if !(length.is_finite() && length > 0.0) {
            return None;
        }
        let mut base_from_joint = Placement::identity();
        let mut axes = [Screw {
            direction: Vector3::zero(),
            point: Vector3::zero(),
        }; 6];
        for (axis, joint) in axes.iter_mut().zip(joints) {
            base_from_joint = base_from_joint * joint.parent_from_joint;
            axis.direction = base_from_joint.rotation * joint.axis;
            axis.point = base_from_joint.translation * length.recip();
        }
        let mut base_from_tool = base_from_joint * *chain.joint_from_tip();
        base_from_tool.translation = base_from_tool.translation * length.recip();
        Some(Self::by_method(
            axes,
            base_from_tool,
            length,
            &Self::method_of(&axes),
        ))
    }

    /// True if an arm with these axes has a closed form.
    pub(super) fn has_closed_form(axes: &[Screw; 6]) -> bool {
        closed_form_of(*axes).is_some() || closed_form_of(reversed(axes)).is_some()
    }

    /// Method for an arm with these axes.
    pub(super) fn method_of(axes: &[Screw; 6]) -> MethodChoice {
        match Self::has_closed_form(axes) {
            true => MethodChoice::default(),
            false => MethodChoice {
                eliminations: rated_eliminations(axes),
            },
        }
    }

    /// Compiles the solver of axes and a pose of the tool at zero joint values, in lengths of the arm.
    pub(super) fn by_method(
        axes: [Screw; 6],
        base_from_tool: Placement<f64>,
        length: f64,
        choice: &MethodChoice,
    ) -> Self {
        let closed_form = closed_form_of(axes).map(|method| (method, false));
        let closed_form = closed_form.or_else(|| Some((closed_form_of(reversed(&axes))?, true)));
        let (method, reversed) = closed_form.unwrap_or_else(|| {
            let choices = choice.eliminations.iter();
            let eliminations =
                choices.filter_map(|&(numbering, size)| Elimination::new(&axes, numbering, size));
            (SolutionMethod::Elimination(eliminations.collect()), false)
        });
        let branch_signs = match (&method, reversed) {
            (SolutionMethod::SphericalWrist(wrist), false) => Some(wrist.branch_signs()),
            (SolutionMethod::ThreeParallel(parallel), false) => Some(parallel.branch_signs()),
            _ => None,
        };
        Self {
            axes,
            tool_from_base: base_from_tool.inverse(),
            tool: base_from_tool.translation,
            length,
            reversed,
            method,
            branch_signs,
        }
    }

    /// Writes all solutions of a target into a set. Tolerances are metres and radians.
    pub(crate) fn solve(
        &self,
        base_from_tool: &Placement<f64>,
        (position_tolerance, orientation_tolerance): (f64, f64),
        set: &mut SolutionSet,
    ) {
        let mut scaled = *base_from_tool;
        scaled.translation = scaled.translation * self.length.recip();
        let displacement = scaled * self.tool_from_base;
        let goal = match self.reversed {
            true => displacement.inverse(),
            false => displacement,
        };
        set.solutions.clear();
        set.roots.clear();
        set.near.clear();
        (set.complete, set.family, set.deviation) = (false, false, 0.0);
        match &self.method {
            SolutionMethod::SphericalWrist(wrist) => {
                set.candidates.clear();
                set.family = wrist.solve(&goal, &mut set.candidates);
                self.collect(&displacement, set);
                set.complete = !set.family;
            }
            SolutionMethod::ThreeParallel(parallel) => {
                set.candidates.clear();
                set.family = parallel.solve(&goal, &mut set.candidates);
                self.collect(&displacement, set);
                set.complete = !set.family;
            }
            SolutionMethod::Elimination(eliminations) => {
                for (index, elimination) in eliminations.iter().enumerate() {
                    set.candidates.clear();
                    let conditioning = elimination.solve(&goal, &mut set.candidates);
                    let known = set.roots.len();
                    let dropped = self.collect(&displacement, set);
                    set.deviation = conditioning.deviation;
                    // Solutions of a regular pose are even in number, as the polynomial's degree is.
                    let is_even = set.roots.len().is_multiple_of(2);
                    let has_solution = |root: &Angle| {
                        let mut solutions = set.roots.iter();
                        solutions.any(|q| elimination.third(q).is_within(ROOT_DISTANCE, *root))
                    };
                    let explains_roots = conditioning.simple_roots().iter().all(has_solution);
                    let is_clear = dropped == 0 && conditioning.other_roots == 0;
                    let is_confirmed = index > 0 && set.roots.len() == known;
                    if is_even && explains_roots && (is_clear || is_confirmed) {
                        set.complete = true;
                        break;
                    }
                }
            }
        }
        self.judge(
            &displacement,
            (position_tolerance, orientation_tolerance),
            set,
        );
    }

    /// Polishes the candidates and keeps the roots. Returns the number of candidates that lead to none.
    fn collect(&self, displacement: &Placement<f64>, set: &mut SolutionSet) -> usize {
        let is_elimination = matches!(self.method, SolutionMethod::Elimination(_));
        let mut dropped = 0;
        for candidate in &mut set.candidates {
            if self.reversed {
                candidate.reverse();
            }
        }
        let (given, mut index) = (set.candidates.len(), 0);
        while let Some(&candidate) = set.candidates.get(index) {
            index += 1;
            let mut q = candidate;
            if is_elimination {
                let error = closure_error(&self.axes, displacement, self.tool, &q);
                if !error.is_within(MAX_CANDIDATE_ERROR) {
                    dropped += usize::from(index <= given);
                    continue;
                }
            }
            let error = polish(&self.axes, displacement, self.tool, &mut q);
            let is_known = |other: &[Angle; 6]| is_closer(other, &q, SAME_SOLUTION);
            if error.is_within(ROOT_ERROR) {
                if !set.roots.iter().any(is_known) {
                    set.roots.push(q);
                    if is_elimination {
                        add_twins(&self.axes, self.tool, &q, &mut set.candidates);
                    }
                }
            } else {
                dropped += usize::from(index <= given);
                // Halfway between two close roots the error is stationary.
                if is_elimination && index <= given && error.is_within(MAX_TWIN_ERROR) {
                    add_twins(&self.axes, self.tool, &q, &mut set.candidates);
                }
                set.near.push((q, error));
            }
        }
        dropped
    }

    /// Keeps the roots, and configurations within the tolerances that are far from every root.
    fn judge(&self, displacement: &Placement<f64>, tolerances: (f64, f64), set: &mut SolutionSet) {
        let SolutionSet {
            solutions,
            roots,
            near,
            ..
        } = set;
        let mut add = |q: &[Angle; 6], error: ClosureError| {
            solutions.push(SetMember {
                q: q.map(Angle::radians),
                position_error: error.position * self.length,
                orientation_error: error.orientation,
                branch: match &self.branch_signs {
                    Some(signs) => signs.branch(&self.axes, q),
                    None => ArmBranch::default(),
                },
            });
        };
        for q in roots.iter() {
            add(q, closure_error(&self.axes, displacement, self.tool, q));
        }
        let exact = roots.len();
        for (q, error) in near.iter() {
            let is_within =
                error.position * self.length <= tolerances.0 && error.orientation <= tolerances.1;
            let is_far = |other: &[Angle; 6]| !is_closer(other, q, VALLEY);
            if is_within && roots.iter().all(is_far) {
                add(q, *error);
                roots.push(*q);
            }
        }
        roots.truncate(exact);
    }

    /// The argument for a set's completeness.
    pub(crate) fn argument(&self, set: &SolutionSet) -> Argument {
        match &self.method {
            _ if set.family => Argument::None,
            SolutionMethod::SphericalWrist(_) if self.reversed => Argument::SphericalShoulder,
            SolutionMethod::SphericalWrist(_) => Argument::SphericalWrist,
            SolutionMethod::ThreeParallel(_) => Argument::ThreeParallelAxes,
            SolutionMethod::Elimination(_) if set.complete => Argument::UnivariatePolynomial {
                deviation: set.deviation,
            },
            SolutionMethod::Elimination(_) => Argument::None,
        }
    }
}

/// Adds candidates next to a nearly singular root, whose twin an elimination may have merged with it.
fn add_twins(
    axes: &[Screw; 6],
    tool: Vector3<f64>,
    root: &[Angle; 6],
    candidates: &mut Vec<[Angle; 6]>,
) {
    let Some(direction) = null_direction(axes, tool, root) else {
        return;
    };
    for distance in TWIN_DISTANCES {
        let mut twin = *root;
        for (angle, v) in twin.iter_mut().zip(direction) {
            *angle = angle.plus(Angle::of_radians(distance * v));
        }
        candidates.push(twin);
    }
}

/// The axes of the chain from tool to base.
fn reversed(axes: &[Screw; 6]) -> [Screw; 6] {
    std::array::from_fn(|i| axes[5 - i].reversed())
}

/// True if all angles of two configurations differ by at most `distance` radians.
fn is_closer(a: &[Angle; 6], b: &[Angle; 6], distance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| a.is_within(distance, *b))
}

/// The closed form of an arm, if it has a spherical wrist or three parallel axes.
fn closed_form_of(axes: [Screw; 6]) -> Option<SolutionMethod> {
    let wrist = SphericalWrist::new(axes, STRUCTURE_TOLERANCE)
        .map(|wrist| SolutionMethod::SphericalWrist(Box::new(wrist)));
    wrist.or_else(|| {
        ThreeParallel::new(axes, STRUCTURE_TOLERANCE)
            .map(|parallel| SolutionMethod::ThreeParallel(Box::new(parallel)))
    })
}

/// The numberings of an arm without a closed form, best conditioned first.
fn rated_eliminations(axes: &[Screw; 6]) -> Vec<(Numbering, f64)> {
    let mut poses = [(Placement::identity(), [Angle::ZERO; 6]); RATED_POSES];
    let mut random = RandomStream::new(0, 1);
    for (displacement, q) in &mut poses {
        for (angle, axis) in q.iter_mut().zip(axes) {
            *angle = Angle::of_radians(std::f64::consts::TAU * random.unit());
            *displacement = *displacement * axis.displacement(*angle);
        }
    }
    let mut rated: Vec<(f64, (Numbering, f64))> = Vec::new();
    for numbering in Numbering::all() {
        let best = PERTURBATIONS.into_iter().filter_map(|size| {
            let elimination = Elimination::new(axes, numbering, size)?;
            let mut errors = poses.map(|(displacement, q)| {
                let error = elimination.root_error(&displacement, &q);
                if error.is_nan() { f64::INFINITY } else { error }
            });
            errors.sort_unstable_by(f64::total_cmp);
            (errors[RATED_POSES / 2] < MAX_ROOT_ERROR)
                .then_some((errors[RATED_POSES - 2], (numbering, size)))
        });
        rated.extend(best.min_by(|a, b| a.0.total_cmp(&b.0)));
    }
    rated.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Opposite perturbations: a pair of solutions that one turns complex stays real with the other.
    let signs = [1.0, -1.0].into_iter().cycle();
    let choices = rated.into_iter().zip(signs);
    let choices = choices.map(|((_, (numbering, size)), sign)| (numbering, sign * size));
    choices.take(NUMBERINGS).collect()
}
