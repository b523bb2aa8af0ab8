//! Configurations as points of a manifold: moved by velocities, compared, drawn at random.
//!
//! A ball joint's part is a unit quaternion and a free joint's a place and a unit quaternion; velocities are
//! in the moved frame's own axes. So q ⊕ v is M exp(v) for each, as in Pinocchio (Solà, Deray & Atchuthan
//! 2018, "A micro Lie theory for state estimation in robotics", eq. 25, 172 and 179 on SO(3) and SE(3)).

use super::parameter_map::{check_configuration, check_length, check_numbers};
use super::rotation_chart::any_rotation;
use super::segment::{Segment, SegmentKind, quaternion_at, write_quaternion};
use super::{JointId, Model, ModelError, RotationChart};
use crate::random::RandomStream;
use crate::spatial::{Matrix3, Quaternion, Vector3, rotation_exp_jacobian, rotation_log_jacobian};

/// So often a rotation is drawn until it is within an angle: of a narrow cone with a wide twist few are.
const DRAWS: usize = 1000;

const VELOCITY: &str = "a velocity of this model";

impl Model {
    /// The configuration closest to all zeros within the limits, balls unturned.
    #[must_use]
    pub fn neutral(&self) -> Vec<f64> {
        let mut q: Vec<f64> = self.limits().map(|limits| limits.clamp(0.0)).collect();
        for (segment, at) in self.balls() {
            write_quaternion(Quaternion::exp(Vector3::zero()), &mut q[at..at + 4]);
            self.keep_ball_within(segment, &mut q[at..at + 4]);
        }
        q
    }

    /// Writes q ⊕ v: where the velocity `v` (radians and metres, [`degrees_of_freedom`](Self::degrees_of_freedom)
    /// numbers) leads from `q` in a unit of time, limits aside. A free joint goes along a screw.
    ///
    /// # Errors
    /// A slice of another length, a number that is not finite, a quaternion of no length.
    pub fn integrate(&self, q: &[f64], v: &[f64], to: &mut [f64]) -> Result<(), ModelError> {
        self.check_configuration(q)?;
        check_length(VELOCITY, v.len(), self.degrees_of_freedom())?;
        check_numbers(VELOCITY, v)?;
        check_length("a configuration of this model", to.len(), q.len())?;
        for segment in &self.segments {
            let (from, to) = (&q[segment.coordinate..], &mut to[segment.coordinate..]);
            let v = &v[segment.velocity..];
            match segment.kind {
                SegmentKind::Scalar => to[0] = from[0] + v[0],
                SegmentKind::Ball => turn(from, v, to),
                SegmentKind::Free => {
                    let way = rotation_exp_jacobian(vector(&v[3..])) * vector(v);
                    let way = rotation(&from[3..]) * way;
                    to[0] = from[0] + way.x;
                    to[1] = from[1] + way.y;
                    to[2] = from[2] + way.z;
                    turn(&from[3..], &v[3..], &mut to[3..]);
                }
            }
        }
        Ok(())
    }

    /// Writes the velocity that leads from one configuration to another in a unit of time, to ⊖ from: the
    /// shortest for balls.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn difference(&self, from: &[f64], to: &[f64], v: &mut [f64]) -> Result<(), ModelError> {
        self.check_configuration(from)?;
        self.check_configuration(to)?;
        check_length(VELOCITY, v.len(), self.degrees_of_freedom())?;
        for segment in &self.segments {
            let (from, to) = (&from[segment.coordinate..], &to[segment.coordinate..]);
            let v = &mut v[segment.velocity..];
            match segment.kind {
                SegmentKind::Scalar => v[0] = to[0] - from[0],
                SegmentKind::Ball => v[..3].copy_from_slice(&turned(from, to).to_array()),
                SegmentKind::Free => {
                    let turned = turned(&from[3..], &to[3..]);
                    let way = rotation(&from[3..]).transpose_mul(vector(to) - vector(from));
                    let straight = rotation_log_jacobian(turned) * way;
                    v[..3].copy_from_slice(&straight.to_array());
                    v[3..6].copy_from_slice(&turned.to_array());
                }
            }
        }
        Ok(())
    }

    /// Writes the configuration at a share of the way between two: from ⊕ share · (to ⊖ from), 0 for the one
    /// and 1 for the other.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate), or a share that is not finite.
    pub fn interpolate(
        &self,
        from: &[f64],
        to: &[f64],
        share: f64,
        between: &mut [f64],
    ) -> Result<(), ModelError> {
        if !share.is_finite() {
            return Err(ModelError::BadShare { share });
        }
        let mut v = vec![0.0; self.degrees_of_freedom()];
        self.difference(from, to, &mut v)?;
        for part in &mut v {
            *part *= share;
        }
        self.integrate(from, &v, between)
    }

    /// Makes the quaternions of a configuration of unit length.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn normalise(&self, q: &mut [f64]) -> Result<(), ModelError> {
        self.check_configuration(q)?;
        for (_, at) in self.balls() {
            if let Some(unit) = quaternion_at(&q[at..]) {
                write_quaternion(unit, &mut q[at..at + 4]);
            }
        }
        Ok(())
    }

    /// Whether every number is within its limits, to the bit, and every ball within its cone and twist, to
    /// rounding. False for a configuration of another length.
    #[must_use]
    pub fn is_within_limits(&self, q: &[f64]) -> bool {
        q.len() == self.configuration_len() && self.outside_limits(q).next().is_none()
    }

    /// The joints that are beyond their limits, in the configuration's order: none where it
    /// [is within them](Self::is_within_limits).
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn joints_outside_limits(&self, q: &[f64]) -> Result<Vec<JointId>, ModelError> {
        self.check_configuration(q)?;
        let mut joints: Vec<_> = self.outside_limits(q).collect();
        joints.sort_unstable_by_key(|(coordinate, _)| *coordinate);
        let mut joints: Vec<_> = joints.into_iter().map(|(_, joint)| joint).collect();
        // A ball has four numbers, and limits of its own.
        joints.dedup();
        Ok(joints)
    }

    /// What is beyond its limits, by coordinate and joint.
    fn outside_limits(&self, q: &[f64]) -> impl Iterator<Item = (usize, JointId)> {
        const ROUNDING: f64 = 1e-12;
        let numbers = q.iter().zip(self.limits()).zip(&self.moving).enumerate();
        let numbers = numbers.filter(|(_, ((value, limits), _))| !limits.contains(**value));
        let balls = self.balls().filter(|(segment, at)| {
            let Some(limits) = self.joints[segment.ball().index()].ball else {
                return false;
            };
            !quaternion_at(&q[*at..])
                .is_some_and(|rotation| self.chart(segment).is_within(rotation, &limits, ROUNDING))
        });
        let numbers = numbers.map(|(coordinate, (_, joint))| (coordinate, *joint));
        numbers.chain(balls.map(|(segment, at)| (at, segment.ball())))
    }

    /// A configuration drawn uniformly within the limits, always the same one for the same seed.
    /// Where a limit is missing, or some turns away, the range ends half a turn (for sliding joints the
    /// model's [`reach`](Self::reach)) away from [`neutral`](Self::neutral). A ball is turned any way alike, or
    /// swung and twisted within its limits.
    #[must_use]
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        // Restarts draw from the streams 1, 2, …; the caller's start is attempt 0.
        let mut random = RandomStream::new(seed, 0);
        let reach = self.reach();
        let mut q = self.neutral();
        for (coordinate, id) in self.moving.iter().enumerate() {
            let joint = &self.joints[id.index()];
            if !joint.kind.is_ball() {
                let spread = self.sampling_spread(joint, reach);
                let (lower, upper) = joint.limits.sampling_range(q[coordinate], spread);
                let share = random.unit();
                q[coordinate] = joint.limits.clamp(lower * (1.0 - share) + upper * share);
            }
        }
        for (segment, at) in self.balls() {
            let drawn = match self.joints[segment.ball().index()].ball {
                None => any_rotation(&mut random),
                Some(limits) => {
                    let chart = self.chart(segment);
                    let within = |rotation: &Quaternion<f64>| {
                        limits
                            .angle
                            .is_none_or(|angle| rotation.log().norm() <= angle)
                    };
                    let mut draws = (0..DRAWS).map(|_| chart.draw(&limits, &mut random));
                    let unturned =
                        quaternion_at(&q[at..]).unwrap_or(Quaternion::exp(Vector3::zero()));
                    draws.find(within).unwrap_or(unturned)
                }
            };
            write_quaternion(drawn, &mut q[at..at + 4]);
        }
        q
    }

    /// One finite number for each coordinate, and quaternions with a direction.
    ///
    /// # Errors
    /// What is not so.
    pub(crate) fn check_configuration(&self, q: &[f64]) -> Result<(), ModelError> {
        check_configuration(self, q)?;
        match self
            .balls()
            .find(|&(_, at)| quaternion_at(&q[at..]).is_none())
        {
            None => Ok(()),
            Some((segment, _)) => Err(ModelError::NoRotation {
                joint: self.joints[segment.ball().index()].name.clone(),
            }),
        }
    }

    /// What of a configuration moves as one, in its order.
    pub(crate) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The coordinates of each free joint.
    pub(crate) fn free_coordinates(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let free = self
            .segments
            .iter()
            .filter(|own| own.kind == SegmentKind::Free);
        free.map(|own| own.coordinate..own.coordinate + own.kind.coordinates())
    }

    /// The balls, also those of free joints, and where their quaternions begin.
    pub(crate) fn balls(&self) -> impl Iterator<Item = (&Segment, usize)> {
        self.segments.iter().filter_map(|segment| {
            let at = segment.quaternion()?;
            Some((segment, at))
        })
    }

    /// The variables of a ball within its limits.
    pub(crate) fn chart(&self, segment: &Segment) -> RotationChart {
        let joint = &self.joints[segment.ball().index()];
        RotationChart::new(joint.axis, joint.ball.as_ref())
    }

    /// Twists an unswung ball into its range.
    fn keep_ball_within(&self, segment: &Segment, quaternion: &mut [f64]) {
        if let Some(limits) = self.joints[segment.ball().index()].ball {
            let twist = limits.twist.clamp(0.0);
            let rotation = self.chart(segment).rotation([0.0, 0.0, twist]);
            write_quaternion(rotation, quaternion);
        }
    }
}

fn vector(numbers: &[f64]) -> Vector3<f64> {
    Vector3::new(numbers[0], numbers[1], numbers[2])
}

/// Of a quaternion that was checked.
fn unit(numbers: &[f64]) -> Quaternion<f64> {
    quaternion_at(numbers).unwrap_or(Quaternion::exp(Vector3::zero()))
}

fn rotation(quaternion: &[f64]) -> Matrix3<f64> {
    unit(quaternion).to_matrix()
}

fn turn(from: &[f64], by: &[f64], to: &mut [f64]) {
    let turned = unit(from) * Quaternion::exp(vector(by));
    // Products of unit quaternions drift by rounding.
    let Quaternion { w, v } = turned;
    write_quaternion(unit(&[w, v.x, v.y, v.z]), &mut to[..4]);
}

/// The rotation vector between two quaternions, in the first one's own axes.
fn turned(from: &[f64], to: &[f64]) -> Vector3<f64> {
    (unit(from).conjugate() * unit(to)).log()
}
