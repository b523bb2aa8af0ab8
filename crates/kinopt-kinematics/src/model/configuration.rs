//! Configurations as points of a manifold: integration, difference, interpolation, limits and sampling.
//!
//! A ball joint has a unit quaternion; a free joint has a position and a unit quaternion. Velocities are in the axes of
//! the moved frame, so q ⊕ v is M exp(v) for each, as in Pinocchio. Source: Solà, Deray & Atchuthan 2018, "A micro Lie
//! theory for state estimation in robotics", eq. 25, 172 and 179 on SO(3) and SE(3).

use super::ball_joint::sample_rotation;
use super::parameter_map::{check_configuration, check_length, check_numbers};
use super::segment::{Segment, SegmentKind, quaternion_at, write_quaternion};
use super::{JointId, Model, ModelError, RotationChart};
use crate::random::RandomStream;
use crate::spatial::{Matrix3, Quaternion, Vector3, rotation_exp_jacobian, rotation_log_jacobian};

/// Largest number of samples of a rotation; few samples of a narrow cone with a wide twist are within the angle limit.
const MAX_SAMPLES: usize = 1000;

const VELOCITY: &str = "a velocity of this model";

impl Model {
    /// The configuration closest to zero within the limits, with ball joints unrotated where their twist range allows.
    #[must_use]
    pub fn neutral(&self) -> Vec<f64> {
        let mut q: Vec<f64> = self.limits().map(|limits| limits.clamp(0.0)).collect();
        for (segment, at) in self.balls() {
            write_quaternion(Quaternion::exp(Vector3::zero()), &mut q[at..at + 4]);
            self.clamp_ball(segment, &mut q[at..at + 4]);
        }
        q
    }

    /// Writes q ⊕ v: the configuration after a unit of time from `q` at velocity `v`, without limits.
    ///
    /// `v` has [`degrees_of_freedom`](Self::degrees_of_freedom) numbers in radians and metres. A free joint moves along
    /// a screw.
    ///
    /// # Errors
    /// Returns an error for a slice of wrong length, a number that is not finite, or a quaternion of zero length.
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
                SegmentKind::Ball => integrate_rotation(from, v, to),
                SegmentKind::Free => {
                    let displacement = rotation_exp_jacobian(vector(&v[3..])) * vector(v);
                    let displacement = rotation(&from[3..]) * displacement;
                    to[0] = from[0] + displacement.x;
                    to[1] = from[1] + displacement.y;
                    to[2] = from[2] + displacement.z;
                    integrate_rotation(&from[3..], &v[3..], &mut to[3..]);
                }
            }
        }
        Ok(())
    }

    /// Writes to ⊖ from: the velocity that moves from one configuration to another in a unit of time.
    ///
    /// Ball joints take the shortest rotation.
    ///
    /// # Errors
    /// Returns the errors of [`integrate`](Self::integrate).
    pub fn difference(&self, from: &[f64], to: &[f64], v: &mut [f64]) -> Result<(), ModelError> {
        self.check_configuration(from)?;
        self.check_configuration(to)?;
        check_length(VELOCITY, v.len(), self.degrees_of_freedom())?;
        for segment in &self.segments {
            let (from, to) = (&from[segment.coordinate..], &to[segment.coordinate..]);
            let v = &mut v[segment.velocity..];
            match segment.kind {
                SegmentKind::Scalar => v[0] = to[0] - from[0],
                SegmentKind::Ball => v[..3].copy_from_slice(&rotation_between(from, to).to_array()),
                SegmentKind::Free => {
                    let angular = rotation_between(&from[3..], &to[3..]);
                    let offset = rotation(&from[3..]).transpose_mul(vector(to) - vector(from));
                    let linear = rotation_log_jacobian(angular) * offset;
                    v[..3].copy_from_slice(&linear.to_array());
                    v[3..6].copy_from_slice(&angular.to_array());
                }
            }
        }
        Ok(())
    }

    /// Writes from ⊕ share · (to ⊖ from): `from` at share 0, `to` at share 1.
    ///
    /// # Errors
    /// Returns the errors of [`integrate`](Self::integrate), or an error for a share that is not finite.
    pub fn interpolate(
        &self,
        from: &[f64],
        to: &[f64],
        share: f64,
        result: &mut [f64],
    ) -> Result<(), ModelError> {
        if !share.is_finite() {
            return Err(ModelError::BadShare { share });
        }
        let mut v = vec![0.0; self.degrees_of_freedom()];
        self.difference(from, to, &mut v)?;
        for component in &mut v {
            *component *= share;
        }
        self.integrate(from, &v, result)
    }

    /// Normalises the quaternions of a configuration to unit length.
    ///
    /// # Errors
    /// Returns the errors of [`integrate`](Self::integrate).
    pub fn normalise(&self, q: &mut [f64]) -> Result<(), ModelError> {
        self.check_configuration(q)?;
        for (_, at) in self.balls() {
            if let Some(unit) = quaternion_at(&q[at..]) {
                write_quaternion(unit, &mut q[at..at + 4]);
            }
        }
        Ok(())
    }

    /// True if every coordinate is within its limits and every ball joint within its cone, twist and angle.
    ///
    /// Coordinates are compared exactly, ball joints up to rounding. Returns false for a configuration of wrong length.
    #[must_use]
    pub fn is_within_limits(&self, q: &[f64]) -> bool {
        q.len() == self.configuration_len() && self.outside_limits(q).next().is_none()
    }

    /// The joints outside their limits, in configuration order.
    ///
    /// Empty if the configuration [is within the limits](Self::is_within_limits).
    ///
    /// # Errors
    /// Returns an error for a configuration of wrong length, a number that is not finite, or a quaternion of zero
    /// length.
    pub fn joints_outside_limits(&self, q: &[f64]) -> Result<Vec<JointId>, ModelError> {
        self.check_configuration(q)?;
        let mut joints: Vec<_> = self.outside_limits(q).collect();
        joints.sort_unstable_by_key(|(coordinate, _)| *coordinate);
        let mut joints: Vec<_> = joints.into_iter().map(|(_, joint)| joint).collect();
        // A ball joint may occur twice: by a quaternion component and by its cone.
        joints.dedup();
        Ok(joints)
    }

    /// Coordinate and joint of each violated limit.
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

    /// A configuration sampled uniformly within the limits; equal seeds give equal configurations.
    ///
    /// A missing or very distant limit is replaced by one half a rotation from [`neutral`](Self::neutral); for
    /// prismatic joints, about the model's [`reach`](Self::reach) from it. A ball joint without limits is sampled
    /// uniformly over all rotations; one with limits, within its swing, twist and angle.
    #[must_use]
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        // The solver's attempts sample from streams 1, 2, …; attempt 0 is the caller's start.
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
            let sampled = match self.joints[segment.ball().index()].ball {
                None => sample_rotation(&mut random),
                Some(limits) => {
                    let chart = self.chart(segment);
                    let is_within_angle = |rotation: &Quaternion<f64>| {
                        limits
                            .angle
                            .is_none_or(|angle| rotation.log().norm() <= angle)
                    };
                    let mut samples = (0..MAX_SAMPLES).map(|_| chart.sample(&limits, &mut random));
                    let unrotated =
                        quaternion_at(&q[at..]).unwrap_or(Quaternion::exp(Vector3::zero()));
                    samples.find(is_within_angle).unwrap_or(unrotated)
                }
            };
            write_quaternion(sampled, &mut q[at..at + 4]);
        }
        q
    }

    /// Checks that `q` has one finite number for each coordinate and no zero quaternion.
    ///
    /// # Errors
    /// Returns the first violation.
    #[doc(hidden)]
    pub fn check_configuration(&self, q: &[f64]) -> Result<(), ModelError> {
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

    /// The segments of a configuration, in its order.
    #[doc(hidden)]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The range of coordinates of each free joint.
    #[doc(hidden)]
    pub fn free_coordinates(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let free = self
            .segments
            .iter()
            .filter(|segment| segment.kind == SegmentKind::Free);
        free.map(|segment| segment.coordinate..segment.coordinate + segment.kind.coordinates())
    }

    /// The ball joints, those of free joints included, each with the index of its quaternion.
    pub(crate) fn balls(&self) -> impl Iterator<Item = (&Segment, usize)> {
        self.segments.iter().filter_map(|segment| {
            let at = segment.quaternion()?;
            Some((segment, at))
        })
    }

    /// The map from the variables of a ball joint to its rotation.
    pub(crate) fn chart(&self, segment: &Segment) -> RotationChart {
        let joint = &self.joints[segment.ball().index()];
        RotationChart::new(joint.axis, joint.ball.as_ref())
    }

    /// Writes the rotation without swing whose twist is closest to zero within the limits.
    fn clamp_ball(&self, segment: &Segment, quaternion: &mut [f64]) {
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

/// The quaternion of a slice that was checked before.
fn unit(numbers: &[f64]) -> Quaternion<f64> {
    quaternion_at(numbers).unwrap_or(Quaternion::exp(Vector3::zero()))
}

fn rotation(quaternion: &[f64]) -> Matrix3<f64> {
    unit(quaternion).to_matrix()
}

fn integrate_rotation(from: &[f64], rotation_vector: &[f64], to: &mut [f64]) {
    let product = unit(from) * Quaternion::exp(vector(rotation_vector));
    // Products of unit quaternions drift by rounding.
    let Quaternion { w, v } = product;
    write_quaternion(unit(&[w, v.x, v.y, v.z]), &mut to[..4]);
}

/// The rotation vector between two quaternions, in the axes of the first, radians.
fn rotation_between(from: &[f64], to: &[f64]) -> Vector3<f64> {
    (unit(from).conjugate() * unit(to)).log()
}
