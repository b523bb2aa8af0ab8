//! Random models with joints of every kind, locked joints and mimic joints, and a check of their configurations.

use std::f64::consts::PI;

use kinopt::Problem;
use kinopt::model::{
    BallLimits, FrameId, JointId, Limits, Masses, Model, ModelBuilder, ParameterMap, PointMass,
};
use kinopt::problem::{Preferences, TaskId};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Plane, Posture, Quantity, Task};

use super::configuration_rules::{Cone, Role, Rule, cross, exponential};
use super::random::Random;
use super::{placement, vector};

/// Model, its parameter map, and the rules of its configurations.
#[derive(Clone, Debug)]
pub struct Body {
    pub model: Model,
    pub map: ParameterMap,
    pub masses: Masses,
    /// One frame on every joint that carries something.
    pub frames: Vec<FrameId>,
    /// Rules by joint, in configuration order.
    pub rules: Vec<Rule>,
    pub roles: Vec<Role>,
}

/// Joints of a model under construction.
struct Parts {
    builder: ModelBuilder,
    /// Name and rule of each joint that moves.
    moving: Vec<(String, Rule)>,
    /// Joints to which the next joint may be attached.
    carriers: Vec<JointId>,
}

impl Body {
    /// Random tree of `joints` joints of every kind, in chains that branch. The first joint may be a base joint.
    pub fn new(random: &mut Random, joints: usize) -> Self {
        let mut parts = Parts {
            builder: Model::builder("body"),
            moving: Vec::new(),
            carriers: Vec::new(),
        };
        for index in 0..joints {
            parts.add(random, index);
        }
        let Parts {
            mut builder,
            moving,
            carriers,
        } = parts;
        let frames: Vec<FrameId> = (carriers.iter().enumerate())
            .map(|(k, &joint)| {
                let at = placement(&random.rigid(0.4));
                builder.frame(format!("frame {k}"), Some(joint), at)
            })
            .collect();
        let model = builder.build().unwrap();
        let points = frames.iter().map(|&frame| PointMass {
            frame,
            at: vector(random.vector(0.2)),
            mass: random.within(0.1, 5.0),
        });
        let masses = Masses::new(&model, points).unwrap();
        let (map, roles) = roles(&model, &moving, random);
        Self {
            map,
            masses,
            frames,
            rules: moving.into_iter().map(|(_, rule)| rule).collect(),
            roles,
            model,
        }
    }

    /// First broken rule of a configuration, if any.
    pub fn broken(&self, q: &[f64]) -> Option<String> {
        super::configuration_rules::broken(&self.rules, &self.roles, q)
    }

    /// Configuration at the edges of all limits. Numbers are at an end of their range, balls on their cones and at an
    /// end of their twist range.
    pub fn on_edges(&self, random: &mut Random) -> Vec<f64> {
        let mut q = Vec::with_capacity(self.model.configuration_len());
        for rule in &self.rules {
            let end = random.below(2) as f64;
            match rule {
                Rule::Number(Limits { lower, upper }) => {
                    let (lower, upper) = (lower.max(-3.0), upper.min(3.0));
                    q.push(if end == 0.0 { lower } else { upper });
                }
                Rule::Ball(None) => {
                    let half_a_turn = random.direction().into_inner() * PI;
                    q.extend(exponential(half_a_turn.into()));
                }
                Rule::Ball(Some(cone)) => {
                    let (sin, cos) = random.within(-PI, PI).sin_cos();
                    q.extend(cone.at([cos, sin], end));
                }
            }
        }
        q
    }

    /// Random configuration without regard to limits: quaternions of any length, values up to `size`.
    pub fn anywhere(&self, random: &mut Random, size: f64) -> Vec<f64> {
        let count = self.model.configuration_len();
        (0..count).map(|_| random.within(-size, size)).collect()
    }
}

impl Parts {
    fn add(&mut self, random: &mut Random, index: usize) {
        let builder = &mut self.builder;
        let last = self.carriers.len();
        let parent = (last > 0).then(|| self.carriers[last - 1 - random.below(last.min(3))]);
        let name = format!("joint {index}");
        let at = placement(&random.rigid(0.4));
        let direction = random.direction().into_inner();
        let perpendicular = cross(direction.into(), random.direction().into_inner().into());
        let perpendicular = nalgebra::Vector3::from(perpendicular).normalize();
        let (axis, about) = (vector(direction), vector(perpendicular));
        // The first joint is a base joint in most cases, and always movable.
        let kind = match index {
            0 => [2, 4, 8, 8][random.below(4)],
            _ => random.below(9),
        };
        let joint_name = name.clone();
        let mut numbers = |part: &str, limits: Limits| {
            let rule = Rule::Number(limits);
            self.moving.push((format!("{joint_name}{part}"), rule));
        };
        let carrier = match kind {
            0 => builder.fixed(name, parent, at),
            1 => {
                let limits = range(random, 2.5);
                let joint = builder.revolute(name, parent, at, axis, limits);
                numbers("", limits);
                joint
            }
            2 => {
                let joint = builder.continuous(name, parent, at, axis);
                numbers("", Limits::UNBOUNDED);
                joint
            }
            3 => {
                let limits = range(random, 0.6);
                let joint = builder.prismatic(name, parent, at, axis, limits);
                numbers("", limits);
                joint
            }
            4 | 5 => {
                let cone = match random.below(4) {
                    0 => None,
                    kind => Some(Cone {
                        axis: direction.into(),
                        about: perpendicular.into(),
                        swing: if kind == 1 { [PI; 2] } else { swing(random) },
                        twist: if kind == 1 {
                            Limits::UNBOUNDED
                        } else {
                            twist(random)
                        },
                        angle: PI,
                    }),
                };
                let cone = cone.map(|cone| whole_angle(cone, random));
                let limits = cone.as_ref().map(|cone| {
                    let limits = BallLimits::elliptic(about, cone.swing, cone.twist);
                    match cone.angle < PI {
                        true => limits.with_angle(cone.angle),
                        false => limits,
                    }
                });
                let joint = builder.ball(name, parent, at, axis, limits);
                self.moving.push((joint_name, Rule::Ball(cone)));
                joint
            }
            6 => {
                let limits = [range(random, 2.0), range(random, 2.0)];
                let joint = builder.universal(name, parent, at, [axis, about], limits);
                for (part, limits) in ["/first", "/second"].into_iter().zip(limits) {
                    numbers(part, limits);
                }
                joint
            }
            7 => {
                let position_limits = [base_bounds(random), base_bounds(random)];
                let yaw = range(random, 3.0);
                let joint = builder.planar(name, parent, at, axis, position_limits, yaw);
                let parts = ["/x", "/y", "/yaw"].into_iter();
                for (part, limits) in parts.zip([position_limits[0], position_limits[1], yaw]) {
                    numbers(part, limits);
                }
                joint
            }
            _ => {
                let position_limits = [
                    base_bounds(random),
                    base_bounds(random),
                    base_bounds(random),
                ];
                let joint = builder.free(name, parent, at, position_limits);
                for (part, limits) in ["/x", "/y", "/z"].into_iter().zip(position_limits) {
                    numbers(part, limits);
                }
                self.moving
                    .push((format!("{joint_name}/rotation"), Rule::Ball(None)));
                joint
            }
        };
        self.carriers.push(carrier);
    }
}

/// Random range around or next to zero; one in nine contains a single value.
fn range(random: &mut Random, size: f64) -> Limits {
    let (a, b) = (random.within(-size, size), random.within(-size, size));
    match random.below(9) {
        0 => Limits::new(a, a),
        1 => Limits::new(a, f64::INFINITY),
        _ => Limits::new(a.min(b), a.max(b)),
    }
}

/// Random base bounds.
fn base_bounds(random: &mut Random) -> Limits {
    match random.below(3) {
        0 => Limits::UNBOUNDED,
        _ => range(random, 1.0),
    }
}

/// Half angles of a cone: circular or elliptic, narrow, wide, or without limit.
fn swing(random: &mut Random) -> [f64; 2] {
    let mut half = || match random.below(8) {
        0 => random.within(1e-3, 0.05),
        1 => PI,
        2 => random.within(1.5, 3.1),
        _ => random.within(0.1, 1.5),
    };
    let (a, b) = (half(), half());
    match random.below(2) {
        0 => [a, a],
        _ => [a, b],
    }
}

/// Adds a limit of the total angle to two of three balls with limits.
fn whole_angle(cone: Cone, random: &mut Random) -> Cone {
    let rest_twist = cone.twist.clamp(0.0).abs();
    let angle = match random.below(3) {
        0 => PI,
        1 => rest_twist + random.within(1e-3, 0.1),
        _ => rest_twist + random.within(0.1, 2.0),
    };
    Cone { angle, ..cone }
}

fn twist(random: &mut Random) -> Limits {
    let (a, b) = (random.within(-PI, PI), random.within(-PI, PI));
    match random.below(6) {
        0 => Limits::UNBOUNDED,
        1 => Limits::new(-PI, PI),
        2 => Limits::new(a, a),
        _ => Limits::new(a.min(b), a.max(b)),
    }
}

/// Random locked joints and mimic joints. Combinations that the parameter map rejects are skipped.
fn roles(
    model: &Model,
    moving: &[(String, Rule)],
    random: &mut Random,
) -> (ParameterMap, Vec<Role>) {
    let mut builder = ParameterMap::builder(model);
    let mut roles = Vec::new();
    let mut source = None;
    for (name, rule) in moving {
        let joint = model.joint(name).unwrap();
        let at = model.coordinate(joint).unwrap();
        match (rule, random.below(10)) {
            (Rule::Number(limits), 0) => {
                let value = limits.lower.max(-1.0).min(limits.upper);
                builder = builder.with_locked(joint, value);
                roles.push(Role::Held(at, vec![value]));
            }
            (Rule::Ball(_), 0) => {
                let turned = exponential(random.vector(2.0).into());
                builder = builder.with_locked_ball(joint, turned.map(|part| part * 3.0));
                roles.push(Role::Held(at, turned.to_vec()));
            }
            (Rule::Number(limits), 1 | 2) => {
                // The line goes through the middles of both ranges, so that the range of the source joint is not empty.
                let Some((other, middle)) = source else {
                    source = Some((joint, in_the_middle(limits)));
                    continue;
                };
                let ratio = random.within(-1.5, 1.5);
                let offset = in_the_middle(limits) - ratio * middle;
                builder = builder.with_coupled(joint, other, ratio, offset);
                let source_index = model.coordinate(other).unwrap();
                roles.push(Role::Follows(at, source_index, ratio, offset));
            }
            _ => {}
        }
    }
    match builder.build() {
        Ok(map) if map.variables() > 0 => (map, roles),
        // Rounding may leave no value for a mimic joint whose range is a single value.
        _ => (ParameterMap::free(model), Vec::new()),
    }
}

fn in_the_middle(limits: &Limits) -> f64 {
    let (lower, upper) = (limits.lower.max(-2.0), limits.upper.min(2.0));
    0.5 * (lower + upper)
}

/// Unit direction as the library's vector type.
pub fn direction(random: &mut Random) -> Vector3<f64> {
    vector(random.direction().into_inner())
}

/// Point mass with two prismatic joints in the ground plane: its model, frame and masses.
pub fn sledge() -> (Model, FrameId, Masses) {
    let mut builder = Model::builder("sledge");
    let [x, y, _] = Vector3::UNITS;
    let (identity, limits) = (Placement::identity(), Limits::new(-5.0, 5.0));
    let along = builder.prismatic("along", None, identity, x, limits);
    let sideways = builder.prismatic("aside", Some(along), identity, y, limits);
    let frame = builder.frame("mass", Some(sideways), identity);
    let model = builder.build().unwrap();
    let (at, mass) = (Vector3::zero(), 2.0);
    let masses = Masses::new(&model, [PointMass { frame, at, mass }]).unwrap();
    (model, frame, masses)
}

/// Problem on [`sledge`] with two priority levels: x = −y, then y = 0 with a tolerance of 1 m. A soft posture task at
/// (0, 2) is weighted against both. Also returns the id of the posture task.
pub fn traded_on_a_sledge() -> (Problem, TaskId<Posture>) {
    let (model, mass, _) = sledge();
    let [x, y, _] = Vector3::UNITS;
    let mut tasks = Problem::builder(&model);
    let plane = |normal| Plane::new(mass, [0.0; 3], normal);
    tasks.add(plane(x + y));
    let level = Task::new(plane(y)).at_level(1);
    tasks.add(level.tolerance(Quantity::Metres, 1.0));
    let posture = tasks.add(Posture::new(&model, &[0.0, 2.0]));
    tasks.preferences(Preferences::Traded);
    (tasks.build().unwrap(), posture)
}
