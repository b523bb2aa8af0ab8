//! Report of a retargeted motion: errors, contacts and collisions.

use crate::motion::score::MotionScore;
use kinopt_kinematics::spatial::Vector3;
use kinopt_solver::problem::Collision;

/// Distance from its touchdown position at which a contact counts as lost, metres.
const LOST_CONTACT_DISTANCE: f64 = 1e-3;

/// Errors, contacts and collisions of a retargeted motion.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RetargetReport {
    /// Samples per second.
    pub frame_rate: f64,
    /// Names of the model's frames that make contact.
    pub contact_frames: Vec<String>,
    /// Contact point of each of these frames, in its coordinates, metres. A frame may appear more than once.
    pub contact_points: Vec<Vector3<f64>>,
    /// Flags whether each of these points is in contact, sample by sample.
    pub contacts: Vec<bool>,
    /// Figures next to the person: direction errors of the limbs, position errors of hands and feet, foot sliding and
    /// more.
    pub score: MotionScore,
    /// Largest distance of a contact point from its touchdown position, metres (foot sliding).
    pub slip: f64,
    /// Largest ground penetration of a foot with a shape, metres; 0 if there is none.
    pub ground_penetration: f64,
    /// Lost contacts: those that limits made impossible to hold until the subject released them.
    pub lost_contacts: Vec<LostContact>,
    /// Samples in collision, with collision avoidance. Online results have collisions only before the first
    /// collision-free sample.
    pub touching: Vec<Touching>,
}

/// Collision at a sample.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Touching {
    /// Index of the sample.
    pub frame: usize,
    /// Nearest or deepest pair.
    pub pair: Collision,
}

/// Lost contact.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LostContact {
    /// First sample with more than 1 mm of foot sliding.
    pub frame: usize,
    /// Name of the model's frame, as in [`RetargetReport::contact_frames`].
    pub contact_frame: String,
}

/// Accumulates foot sliding and lost contacts.
#[derive(Debug)]
pub(super) struct Measures {
    states: Vec<ContactState>,
    pub(super) slip: f64,
    pub(super) ground_penetration: f64,
    /// Lost contacts: sample and limb.
    pub(super) lost_contacts: Vec<(usize, usize)>,
}

/// Contact state of a limb, with its touchdown position.
#[derive(Clone, Copy, Debug)]
enum ContactState {
    None,
    At(Vector3<f64>),
    LostContact,
}

impl Measures {
    pub(super) fn new(limbs: usize) -> Self {
        Self {
            states: vec![ContactState::None; limbs],
            slip: 0.0,
            ground_penetration: 0.0,
            lost_contacts: Vec::new(),
        }
    }

    /// Adds one limb at one sample. The flag is its planned contact. Returns whether it is in contact.
    pub(super) fn add(
        &mut self,
        frame: usize,
        limb: usize,
        position: Vector3<f64>,
        planned: bool,
    ) -> bool {
        let state = &mut self.states[limb];
        match (planned, *state) {
            (false, _) => *state = ContactState::None,
            (true, ContactState::None) => *state = ContactState::At(position),
            (true, ContactState::At(touchdown)) => {
                let slipped = (position - touchdown).norm();
                if slipped > LOST_CONTACT_DISTANCE {
                    *state = ContactState::LostContact;
                    self.lost_contacts.push((frame, limb));
                } else {
                    self.slip = self.slip.max(slipped);
                }
            }
            (true, ContactState::LostContact) => {}
        }
        matches!(state, ContactState::At(_))
    }
}

#[cfg(test)]
mod tests {
    use super::Measures;
    use kinopt_kinematics::spatial::Vector3;

    #[test]
    fn slipped_contact_counts_again_only_after_release() {
        let mut measures = Measures::new(1);
        let mut add = |frame: usize, x: f64, planned: bool| {
            let position = Vector3::new(x, 0.0, 0.0);
            measures.add(frame, 0, position, planned)
        };
        assert!(add(0, 0.0, true) && add(1, 0.9e-3, true));
        // A slide counts once, independent of its length.
        for frame in 2..9 {
            assert!(!add(frame, 2e-3 * frame as f64, true), "{frame}");
        }
        assert!(!add(9, 0.1, false) && add(10, 0.1, true));
        assert_eq!(measures.lost_contacts, [(2, 0)]);
        assert_eq!(measures.slip, 0.9e-3);
    }
}
